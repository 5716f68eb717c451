"""Worlds from a floor plan: walls and furniture are painted into the map, so that map and boxes agree."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.world import Furniture, WorldObject, mark_touched
from zavis_bt.mapping.map_server import save_map
from zavis_bt.types import FREE, OCCUPIED, GridMap, Pose2D

RESOLUTION = 0.05
_RIM = 3  # cells of outer wall


class Wall(NamedTuple):
    """A rectangle of wall with edges on cell borders [m]."""

    x0: float
    y0: float
    x1: float
    y1: float


@dataclass(frozen=True, slots=True)
class FloorPlan:
    """What a world is drawn from; the inside is x from 0 to width and y from 0 to depth."""

    name: str
    source: str
    width: float
    depth: float
    walls: Sequence[Wall]
    furniture: Sequence[Furniture]
    objects: Sequence[WorldObject]
    starts: Sequence[Pose2D]
    wall_height: float = 2.5

    def grid(self) -> GridMap:
        """Return the map: the cells of walls, of the outer wall, and all cells that touch a furniture box."""
        inside = round(self.depth / RESOLUTION), round(self.width / RESOLUTION)
        solid: NDArray[np.bool_] = np.pad(np.zeros(inside, dtype=np.bool_), _RIM, constant_values=True)
        origin = -_RIM * RESOLUTION, -_RIM * RESOLUTION
        empty = GridMap(np.zeros(solid.shape, dtype=np.int8), RESOLUTION, origin)
        for wall in self.walls:
            col0, row0, col1, row1 = (round(edge / RESOLUTION) + _RIM for edge in wall)
            solid[row0:row1, col0:col1] = True
        for piece in self.furniture:
            mark_touched(solid, empty, piece)
        states = np.where(solid, OCCUPIED, FREE).astype(np.int8)
        states.setflags(write=False)
        return GridMap(states, RESOLUTION, origin)


def write_world(plan: FloorPlan, folder: Path) -> Path:
    """Write ``<name>.world.yaml``, ``<name>.yaml`` and ``<name>.pgm``; returns the first."""
    save_map(folder / f"{plan.name}.yaml", plan.grid())
    path = folder / f"{plan.name}.world.yaml"
    path.write_text("\n".join(_lines(plan)) + "\n", encoding="utf-8")
    return path


def _lines(plan: FloorPlan) -> Iterable[str]:
    yield "format: zavis-world/1"
    yield f"name: {plan.name}"
    yield f"source: {plan.source}"
    yield f"map: {plan.name}.yaml"
    yield f"wall_height: {plan.wall_height:g}"
    yield "furniture:"
    for piece in plan.furniture:
        yield (
            f"  - {{id: {piece.id}, category: {piece.category}, x: {piece.x:.3f}, y: {piece.y:.3f}, "
            f"yaw_deg: {math.degrees(piece.yaw):g}, size: [{piece.length:.3f}, {piece.width:.3f}], "
            f"height: {piece.height:.2f}{_paint(piece)}}}"
        )
    yield "objects:"
    for thing in plan.objects:
        size = ", ".join(f"{extent:.3f}" for extent in thing.size)
        on = f", on: {thing.on}" if thing.on else ""
        yield (
            f"  - {{id: {thing.id}, category: {thing.category}, x: {thing.x:.3f}, y: {thing.y:.3f}, z: {thing.z:.3f}, "
            f"size: [{size}]{on}{_paint(thing)}}}"
        )
    yield "starts:                        # x, y, yaw_deg"
    for pose in plan.starts:
        yield f"  - [{pose.x:g}, {pose.y:g}, {math.degrees(pose.yaw):g}]"


def _paint(thing: Furniture | WorldObject) -> str:
    colour = f", colour: {thing.colour}" if thing.colour else ""
    return colour + (f", appearance: {thing.appearance}" if thing.appearance is not None else "")
