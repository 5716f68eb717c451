"""Labelled images of random rooms, written as a COCO data set."""

from __future__ import annotations

import json
import math
import signal
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.appearance import SHAPES, THINGS, CameraEffects, random_frame, random_scene, random_standing_frame
from sim.frame import SimFrame
from sim.render_labels import Label
from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.types import Box, CameraIntrinsics

_QUALITY = 92  # of the JPEG files
_FRAMES_A_ROOM = 4
_STANDING = 0.35  # share of the views that aim at nothing
_FILE = "annotations.json"
_RENDERED = "rendered by zavis_bt's simulator"

_Labelled = tuple[dict[str, Any], list[dict[str, Any]]]
"""An image and its annotations, as COCO writes them."""


@dataclass(frozen=True, slots=True)
class FrameRecipe:
    """What the images of a data set have in common."""

    seed: int = 0
    """Of all rooms and views; image k of a seed is the same in data sets of any length."""
    width: int = 640
    """Of the images [px]; their height is three quarters of it."""
    horizontal_fov: float = math.radians(60)
    """[rad]"""
    distance: tuple[float, float] = (0.4, 4.0)
    """Of the camera from the thing in the image's middle [m]."""
    categories: tuple[str, ...] = THINGS
    """What is in the rooms; a name that stands there twice is drawn twice as often."""
    least_side: float = 12.0
    """Things whose box is narrower are marked as not to be counted (``iscrowd``) [px]."""
    least_visible: float = 0.3
    """The same for things of which less is in sight, be the rest hidden or beyond the image's border [share]."""


def chosen_categories(without: Iterable[str] = (), also: Iterable[str] = ()) -> tuple[str, ...]:
    """Return the categories of a recipe: all but some, some of them twice as often as the others.

    Args:
        without: Never drawn.
        also: Drawn once more each time they are named.

    Raises:
        InputError: A category is unknown, both left out and wanted, or none is left.
    """
    without, also = tuple(without), tuple(also)
    for name in (*without, *also):
        if name not in SHAPES:
            raise InputError(f"frames: there is no category '{name}'{did_you_mean(name, SHAPES)}")
    both = next((name for name in also if name in without), None)
    if both is not None:
        raise InputError(f"frames: '{both}' cannot be left out and drawn more often (name it once)")
    left = tuple(name for name in THINGS if name not in without)
    if not left:
        raise InputError("frames: no category is left to draw (leave out fewer)")
    return left + also


def write_frames(folder: Path, count: int, recipe: FrameRecipe, workers: int = 1) -> Iterator[int]:
    """Write a data set: ``images/*.jpg`` and ``annotations.json`` in COCO's form.

    Annotations have two fields more than COCO's: ``colour``, a basic colour's name or null, and
    ``visible_fraction``. Images come with blur, noise and exposure of a camera.

    Args:
        folder: New or empty.
        count: Number of images.
        recipe: What they show.
        workers: Processes.

    Yields:
        How many images are written, after each room.

    Raises:
        InputError: The folder holds something or cannot be written, a category is unknown, or a number is out of its
            range.
    """
    _check(folder, count, recipe)
    _begin(folder)
    rooms = range(math.ceil(count / _FRAMES_A_ROOM))
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for written in _rooms(partial(_write_room, folder=folder, recipe=recipe, count=count), rooms, workers):
        for image, labels in written:
            images.append(image)
            annotations += [{"id": len(annotations) + k + 1, **label} for k, label in enumerate(labels)]
        yield len(images)
    document = {
        "info": {"description": f"random rooms, {_RENDERED}", "seed": recipe.seed, "rendered": True},
        "images": images,
        "annotations": annotations,
        "categories": [{"id": number, "name": name} for name, number in _numbers().items()],
    }
    _finish(folder, document)


def frames_of_room(recipe: FrameRecipe, room: int) -> Iterator[tuple[SimFrame, NDArray[np.uint8]]]:
    """Yield the views of one random room: the frame, which knows its labels, and its image (h, w, 3)."""
    rng = np.random.default_rng([recipe.seed, room])
    scene = random_scene(rng, recipe.categories)
    camera = CameraIntrinsics.from_fov(recipe.width, recipe.width * 3 // 4, recipe.horizontal_fov)
    for _ in range(_FRAMES_A_ROOM):
        if rng.random() < _STANDING:
            frame = random_standing_frame(rng, scene, camera)
        else:
            frame = random_frame(rng, scene, camera, recipe.distance)
        yield frame, CameraEffects.drawn(rng, recipe.width).apply(frame.rgb, rng)


def _check(folder: Path, count: int, recipe: FrameRecipe) -> None:
    if folder.is_dir() and any(folder.iterdir()):
        raise InputError(f"{folder}: is not empty (name a new folder)")
    if count < 1 or not 16 <= recipe.width <= 4096:
        raise InputError(f"frames: {count} images of width {recipe.width} (at least 1, of 16 to 4096 px)")
    strange = [name for name in recipe.categories if name not in SHAPES]
    if strange or not recipe.categories:
        raise InputError(f"frames: no category {', '.join(strange) or 'at all'} (see docs/appearance.md)")
    if not 0 < recipe.distance[0] <= recipe.distance[1]:
        raise InputError(f"frames: distances of {recipe.distance[0]:g} to {recipe.distance[1]:g} m (nearest first)")


def _begin(folder: Path) -> None:
    try:
        (folder / "images").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made: {error.strerror}") from error


def _finish(folder: Path, document: dict[str, Any]) -> None:
    """Write the annotations last and at once: a folder that has them is whole."""
    unfinished = folder / f"{_FILE}.part"
    try:
        unfinished.write_text(json.dumps(document, separators=(",", ":")))
        unfinished.replace(folder / _FILE)
    except OSError as error:
        raise InputError(f"{folder / _FILE}: cannot be written: {error.strerror}") from error


def _rooms(write: Callable[[int], list[_Labelled]], rooms: range, workers: int) -> Iterable[list[_Labelled]]:
    if workers == 1:
        yield from map(write, rooms)
        return
    # Ctrl-C reaches all processes of a terminal: only this one is to answer it.
    with get_context("spawn").Pool(workers, signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        yield from pool.imap(write, rooms, chunksize=8)


def _write_room(room: int, *, folder: Path, recipe: FrameRecipe, count: int) -> list[_Labelled]:
    cv2.setNumThreads(1)
    written = []
    for view, (frame, rgb) in enumerate(frames_of_room(recipe, room)):
        number = room * _FRAMES_A_ROOM + view
        if number >= count:
            break
        name = f"{number:06d}.jpg"
        file = folder / "images" / name
        if not cv2.imwrite(str(file), rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _QUALITY]):
            raise InputError(f"{file}: cannot be written (is the disk full?)")
        height, width = rgb.shape[:2]
        image = {"id": number, "file_name": f"images/{name}", "width": width, "height": height}
        written.append((image, [_annotation(label, number, recipe) for label in labels_in(frame)]))
    return written


def labels_in(frame: SimFrame) -> list[Label]:
    """Return what a frame shows of the catalogue's things, with the share of the whole thing that is in sight.

    What the image's border cuts off is not in sight, unlike in `SimFrame.labels`.
    """
    inside = {view.id: _share_inside(view.full_box, frame.intrinsics) for view in frame.instances}
    worth = (label for label in frame.labels if label.pixels >= 9 and label.category in SHAPES)
    return [label._replace(visible_fraction=label.visible_fraction * inside.get(label.id, 1.0)) for label in worth]


def _share_inside(box: Box, camera: CameraIntrinsics) -> float:
    return box.intersection(Box(0.0, 0.0, camera.width, camera.height)) / max(box.area, 1.0)


def _annotation(label: Label, image: int, recipe: FrameRecipe) -> dict[str, Any]:
    x0, y0, x1, y1 = label.box
    hardly = min(x1 - x0, y1 - y0) < recipe.least_side or label.visible_fraction < recipe.least_visible
    return {
        "image_id": image,
        "category_id": _numbers()[label.category],
        "bbox": [x0, y0, x1 - x0, y1 - y0],
        "area": label.pixels,
        "iscrowd": int(hardly),
        "colour": label.colour,
        "visible_fraction": round(label.visible_fraction, 3),
    }


def _numbers() -> dict[str, int]:
    return {name: number for number, name in enumerate(SHAPES, start=1)}
