"""Crops to train on, cut out of a data set once and kept on disk."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError
from zavis_bt.perception.clip.backgrounds import draw_backgrounds
from zavis_bt.perception.clip.captions import EMPTY, NO_COLOUR, PART
from zavis_bt.perception.clip.colours import Pair, held_out_pairs
from zavis_bt.perception.clip.gallery import LEAST_SIDE, shorter_side
from zavis_bt.perception.datasets import DetectionDataset

MARGIN = 1.25
"""A patch's side over the longer side of its box: room for boxes that are a little off."""
_PIXELS, _TABLE = "patches.npy", "patches.npz"
_PSEUDO = (EMPTY, PART)

Report = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Patches:
    """Square pieces of images around boxes."""

    pixels: NDArray[np.uint8]
    """(n, s, s, 3); black beyond the image."""
    boxes: NDArray[np.float32]
    """(n, 4) the box in its patch, as shares of the side."""
    limits: NDArray[np.float32]
    """(n, 4) the image in the patch, as shares of the side."""
    lengths: NDArray[np.float32]
    """(n,) longer side of the box in its image [px at 640 px width]."""
    categories: NDArray[np.int32]
    """(n,) indices into `names`; two more for crops of background, `EMPTY` and `PART`."""
    colours: NDArray[np.int32]
    """(n,) indices into `colour_names`, or `NO_COLOUR`."""
    visible: NDArray[np.float32]
    """(n,) share in sight."""
    names: tuple[str, ...]
    colour_names: tuple[str, ...]
    held_out: tuple[str, ...]
    """Colour and category that were left out, such as ``red wallet``."""
    rendered: bool
    """Whether a simulator drew the images."""

    @property
    def background(self) -> NDArray[np.bool_]:
        """(n,) whether a patch shows no whole thing."""
        return self.categories >= len(self.names)


def collect_patches(
    dataset: DetectionDataset,
    folder: Path,
    size: int,
    *,
    backgrounds: int = 3,
    hold_out: bool = True,
    seed: int = 0,
    report: Report | None = None,
) -> Patches:
    """Cut all things that count, and some background, out of a data set, or read what was cut out before.

    Args:
        dataset: Images and boxes.
        folder: Where the patches are kept.
        size: Side of the squares the model reads [px].
        backgrounds: Boxes without a thing, of each image.
        hold_out: Whether a tenth of the pairs of colour and category is left out.
        seed: Of the draws of background.
        report: Called with the number of images done and of all.

    Raises:
        InputError: No thing counts.
    """
    side = round(size * MARGIN)
    key = json.dumps([dataset.name, len(dataset), side, backgrounds, hold_out, seed, "many-coloured"])
    if (found := _read(folder, key)) is not None:
        return found
    rng = np.random.default_rng(seed)
    folder.mkdir(parents=True, exist_ok=True)
    held = held_out_pairs(_pairs(dataset)) if hold_out else frozenset()
    rows = [_boxes(dataset, index, backgrounds, held, rng) for index in range(len(dataset))]
    total = sum(map(len, rows))
    if not any(name not in _PSEUDO for image in rows for _, name, _, _ in image):
        raise InputError(f"{dataset.name}: shows nothing to train on (things of at least {LEAST_SIDE:g} px that count)")
    pixels = np.lib.format.open_memmap(folder / _PIXELS, "w+", np.uint8, (total, side, side, 3))
    frames = np.zeros((total, 2, 4), dtype=np.float32)
    done = 0
    for index, image in enumerate(rows):
        rgb = dataset.image(index) if image else None
        for box, _, _, _ in image:
            assert rgb is not None
            pixels[done], frames[done, 0], frames[done, 1] = cut_patch(rgb, box, side)
            done += 1
        if report:
            report(index + 1, len(dataset))
    pixels.flush()
    _write(folder, key, dataset, [row for image in rows for row in image], frames, held)
    patches = _read(folder, key)
    assert patches is not None
    return patches


def read_patches(folder: Path) -> Patches:
    """Return patches that were cut out before.

    Raises:
        InputError: There are none.
    """
    patches = _read(folder, None)
    if patches is None:
        raise InputError(f"{folder}: holds no crops (name the --out folder of zavis matcher train)")
    return patches


def cut_patch(
    rgb: NDArray[np.uint8], box: NDArray[np.float64], side: int
) -> tuple[NDArray[np.uint8], NDArray[np.float64], NDArray[np.float64]]:
    """Return a square patch around a box, the box in it, and the image in it, both as shares of the side."""
    height, width = rgb.shape[:2]
    span = max(math.ceil(max(box[2] - box[0], box[3] - box[1]) * MARGIN), 1)
    left, top = (math.floor((box[k] + box[k + 2] - span) / 2) for k in (0, 1))
    x0, y0, x1, y1 = max(left, 0), max(top, 0), min(left + span, width), min(top + span, height)
    beyond = (y0 - top, top + span - y1, x0 - left, left + span - x1)
    square = cv2.copyMakeBorder(rgb[y0:y1, x0:x1], *beyond, cv2.BORDER_CONSTANT, value=(0, 0, 0))
    how = cv2.INTER_AREA if span > side else cv2.INTER_LINEAR
    corner = np.array([left, top, left, top], dtype=np.float64)
    image = np.array([0, 0, width, height], dtype=np.float64)
    patch = np.asarray(cv2.resize(square, (side, side), interpolation=how), dtype=np.uint8)
    return patch, (box - corner) / span, np.clip((image - corner) / span, 0, 1)


_Row = tuple[NDArray[np.float64], str, str, float]  # box, category, colour, share in sight


def _pairs(dataset: DetectionDataset) -> set[Pair]:
    things = (thing for index in range(len(dataset)) for thing in dataset.annotations(index))
    return {(thing.colour or "", thing.category) for thing in things}


def _boxes(
    dataset: DetectionDataset, index: int, backgrounds: int, held: frozenset[Pair], rng: np.random.Generator
) -> list[_Row]:
    size, things = dataset.size(index), dataset.annotations(index)
    boxes = np.array([thing.box for thing in things], dtype=np.float64).reshape(-1, 4)
    rows: list[_Row] = []
    for thing, box in zip(things, boxes, strict=True):
        colour = thing.colour or ""
        if not thing.ignored and (colour, thing.category) not in held and shorter_side(thing.box, size) >= LEAST_SIDE:
            rows.append((box, thing.category, colour, thing.visible))
    rows += [(box, kind, "", 1.0) for box, kind in draw_backgrounds(boxes, size, backgrounds, rng)]
    return rows


def _write(
    folder: Path,
    key: str,
    dataset: DetectionDataset,
    rows: list[_Row],
    frames: NDArray[np.float32],
    held: frozenset[Pair],
) -> None:
    names = sorted({name for _, name, _, _ in rows} - set(_PSEUDO))
    colours = sorted({colour for _, _, colour, _ in rows} - {""})
    number = {name: k for k, name in enumerate((*names, *_PSEUDO))}
    of_colour = {"": NO_COLOUR} | {colour: k for k, colour in enumerate(colours)}
    np.savez(
        folder / _TABLE,
        key=np.array(key),
        frames=frames,
        lengths=np.array([max(b[2] - b[0], b[3] - b[1]) for b, _, _, _ in rows], dtype=np.float32),
        categories=np.array([number[name] for _, name, _, _ in rows], dtype=np.int32),
        colours=np.array([of_colour[colour] for _, _, colour, _ in rows], dtype=np.int32),
        visible=np.array([visible for _, _, _, visible in rows], dtype=np.float32),
        names=np.array(names),
        colour_names=np.array(colours, dtype=np.str_),
        held_out=np.array(sorted(" ".join(pair) for pair in held), dtype=np.str_),
        rendered=np.array(dataset.rendered),
    )


def _read(folder: Path, key: str | None) -> Patches | None:
    if not (folder / _TABLE).is_file() or not (folder / _PIXELS).is_file():
        return None
    with np.load(folder / _TABLE) as table:
        if "held_out" not in table or (key is not None and str(table["key"]) != key):
            return None  # of another form, or of other data
        return Patches(
            np.load(folder / _PIXELS, mmap_mode="r"),
            table["frames"][:, 0],
            table["frames"][:, 1],
            table["lengths"],
            table["categories"],
            table["colours"],
            table["visible"],
            tuple(table["names"].tolist()),
            tuple(table["colour_names"].tolist()),
            tuple(table["held_out"].tolist()),
            bool(table["rendered"]),
        )
