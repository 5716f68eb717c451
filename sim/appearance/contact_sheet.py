"""Pictures of every category: ``python -m sim.appearance.contact_sheet FILE.png [CATEGORY …]``."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.appearance.catalogue import SHAPES, shape_of
from sim.appearance.room import Covering, RoomLook
from sim.frame import SimFrame
from sim.scene import Scene
from sim.world import Furniture, World, WorldObject
from zavis_bt.types import FREE, CameraIntrinsics, FloatArray, GridMap

_STUDIO = RoomLook(floor=Covering((226, 224, 220), (226, 224, 220)))
_FIELD = math.radians(28)


def portrait(category: str, pixels: int = 96, number: int = 0, colour: str | None = None) -> NDArray[np.uint8]:
    """Return a picture (pixels, pixels, 3) of one thing before an empty background.

    Args:
        category: What it is.
        pixels: Side of the picture.
        number: Of the look; another one is another thing of the kind.
        colour: Its body's colour, if it is to have a certain one.
    """
    shape = shape_of(category)
    length, width, height = shape.size
    states = np.full((80, 80), FREE, dtype=np.int8)
    grid = GridMap(states, 0.25, (-10.0, -10.0))
    piece = Furniture("thing", category, 0.0, 0.0, 0.0, length, width, height, colour, number)
    world = World("studio", grid, 2.5, (piece,)) if shape.where == "floor" else None
    if world is None:
        thing = WorldObject("thing", category, 0.0, 0.0, 0.0, shape.size, None, colour, number)
        world = World("studio", grid, 2.5, (), (thing,))
    front = math.radians(-62 + 22 * (number % 3 - 1)) + (math.pi / 2 if shape.pose == "ahead" else 0.0)
    slope = math.radians(42 if height < 0.45 * max(length, width) else 24)
    transform = _looking(
        np.array([0.0, 0.0, (height + shape.rise) / 2]), front, slope, _distance(shape.size, shape.rise)
    )
    camera = CameraIntrinsics.from_fov(2 * pixels, 2 * pixels, _FIELD)
    frame = SimFrame(Scene.of(world, _STUDIO), camera, transform, transform, 0.0, (0.01, 100.0))
    return np.asarray(cv2.resize(frame.rgb, (pixels, pixels), interpolation=cv2.INTER_AREA), dtype=np.uint8)


def contact_sheet(categories: Sequence[str], pixels: int = 56, looks: int = 2, columns: int = 8) -> NDArray[np.uint8]:
    """Return a picture with some looks of each category beside one another, and their names."""
    cells = []
    for category in categories:
        row = np.hstack([portrait(category, pixels, number) for number in range(looks)])
        name = np.full((16, row.shape[1], 3), 255, dtype=np.uint8)
        cv2.putText(name, category, (3, 12), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (20, 20, 20), 1, cv2.LINE_AA)
        cells.append(np.pad(np.vstack((name, row)), ((0, 4), (0, 8), (0, 0)), constant_values=255))
    cells += [np.full_like(cells[0], 255)] * (-len(cells) % columns)
    return np.vstack([np.hstack(cells[k : k + columns]) for k in range(0, len(cells), columns)])


def _distance(size: Sequence[float], rise: float) -> float:
    return 0.56 * math.hypot(size[0], size[1], size[2] + rise) / math.tan(_FIELD / 2)


def _looking(at: FloatArray, bearing: float, slope: float, distance: float) -> FloatArray:
    """Return the pose (4, 4) of a camera that looks at a point from a bearing, down a slope."""
    back = np.array([math.cos(bearing) * math.cos(slope), math.sin(bearing) * math.cos(slope), math.sin(slope)])
    right = np.array([-math.sin(bearing), math.cos(bearing), 0.0])
    transform = np.eye(4)
    transform[:3, :3] = np.column_stack((right, np.cross(-back, right), -back))
    transform[:3, 3] = at + distance * back
    return transform


def main(arguments: Sequence[str]) -> None:
    """Write a sheet."""
    if not arguments:
        sys.exit("usage: python -m sim.appearance.contact_sheet FILE.png [CATEGORY …]")
    sheet = contact_sheet(list(arguments[1:]) or sorted(SHAPES))
    cv2.imwrite(arguments[0], sheet[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])


if __name__ == "__main__":
    main(sys.argv[1:])
