"""A world as the camera sees it: boxes, walls and a floor, with their colours."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.render_paint import box_paint, furniture_colour, object_colour, room_paint
from sim.render_rays import CARRIES, COS, CX, HX, SIN, WALL_SLACK, IntArray, Solids, cast_rays
from sim.world import Furniture, World, WorldObject
from zavis_bt.types import FloatArray

_HULL_TOLERANCE = 0.05  # [m] by which an object's centre may stick out of the furniture that holds it


@dataclass(frozen=True, eq=False)
class Scene:
    """What can be seen of a world. Box i is ``furniture[i]``, after the furniture come the objects."""

    furniture: tuple[Furniture, ...]
    objects: tuple[WorldObject, ...]
    solids: Solids

    @classmethod
    def of(cls, world: World) -> Scene:
        """Return the scene of a world; see `sim.render_rays` for what hides what."""
        boxes = _boxes(world)
        hulls = _hulls(world, boxes)
        boxes[hulls[hulls >= 0], CARRIES] = 1.0
        (x, y), grid = world.grid.origin, world.grid
        room = np.array([x, y, grid.resolution, world.wall_height], dtype=np.float64)
        solids = Solids(boxes, hulls, _clearance(np.ascontiguousarray(world.walls)), room)
        for array in solids:
            array.setflags(write=False)
        return cls(world.furniture, world.objects, solids)

    @property
    def things(self) -> tuple[Furniture | WorldObject, ...]:
        """What each box is."""
        return self.furniture + self.objects

    @cached_property
    def paints(self) -> NDArray[np.uint8]:
        """(6 n + 9, 3) lit colours: the six faces of each box, then `room_paint`."""
        colours = [furniture_colour(piece.category) for piece in self.furniture]
        colours += [object_colour(thing.category, thing.colour) for thing in self.objects]
        boxes = box_paint(colours, self.solids.boxes[:, COS : SIN + 1])
        return np.vstack((boxes.reshape(-1, 3), room_paint()))

    def cast(self, origin: FloatArray, directions: FloatArray) -> tuple[FloatArray, IntArray]:
        """Return what rays see.

        Args:
            origin: (3,) where they start, map frame [m].
            directions: (n, 3) of any length.

        Returns:
            (n,) distances in units of the direction's length, inf where nothing is hit; (n,) surface ids: the index
            of a box, or `NOTHING`, `FLOOR`, `WALL` of `sim.render_rays`.
        """
        directions = np.ascontiguousarray(directions, dtype=np.float64)
        distances, surfaces = np.empty(len(directions)), np.empty(len(directions), dtype=np.int32)
        cast_rays(self.solids, np.asarray(origin, dtype=np.float64), directions, distances, surfaces)
        return distances, surfaces


def _boxes(world: World) -> FloatArray:
    """Return the boxes of `Solids`, nothing carried yet."""
    rows = [
        (f.x, f.y, f.height / 2, f.length / 2, f.width / 2, f.height / 2, math.cos(f.yaw), math.sin(f.yaw), 0.0, 0.0)
        for f in world.furniture
    ]
    for o in world.objects:
        length, width, height = o.size
        slack = WALL_SLACK if _touches_wall(world, o) else 0.0
        rows.append((o.x, o.y, o.z + height / 2, length / 2, width / 2, height / 2, 1.0, 0.0, slack, 0.0))
    return np.array(rows, dtype=np.float64).reshape(-1, 10)


def _hulls(world: World, boxes: FloatArray) -> IntArray:
    """Return (n, h) the boxes that are open towards each object: its carrier, and what holds its centre."""
    centres, halves, cos, sin = boxes[:, CX:HX], boxes[:, HX:COS], boxes[:, COS], boxes[:, SIN]
    offsets = centres[:, None] - centres[None]  # [object, box]
    along = cos * offsets[..., 0] + sin * offsets[..., 1]
    across = cos * offsets[..., 1] - sin * offsets[..., 0]
    local = np.abs(np.stack((along, across, offsets[..., 2]), axis=-1))
    count = len(world.furniture)
    tolerance = np.where(np.arange(len(centres)) < count, _HULL_TOLERANCE, 0.0)
    holds = np.all(local <= halves + tolerance[:, None], axis=-1)
    holds[:count] = False
    np.fill_diagonal(holds, False)
    places = {piece.id: place for place, piece in enumerate(world.furniture)}
    for number, thing in enumerate(world.objects, start=count):
        if thing.on in places:
            holds[number, places[thing.on]] = True
    hulls = np.full((len(centres), max(int(holds.sum(axis=1).max(initial=0)), 1)), -1, dtype=np.int32)
    for number, row in enumerate(holds):
        carriers = np.flatnonzero(row)
        hulls[number, : len(carriers)] = carriers
    return hulls


def _touches_wall(world: World, thing: WorldObject) -> bool:
    """Return whether the object's box shares ground with a wall cell."""
    half_x, half_y = thing.size[0] / 2, thing.size[1] / 2
    corners = np.array([[thing.x - half_x, thing.y - half_y], [thing.x + half_x, thing.y + half_y]])
    lower, upper = ((corners - world.grid.origin) / world.grid.resolution).tolist()
    rows = slice(max(math.floor(lower[1]), 0), max(math.floor(upper[1]) + 1, 0))
    cols = slice(max(math.floor(lower[0]), 0), max(math.floor(upper[0]) + 1, 0))
    return bool(world.walls[rows, cols].any())


@njit(cache=True, nogil=True)
def _clearance(walls: NDArray[np.bool_]) -> IntArray:
    """Return (rows, cols) chessboard distance to the nearest wall cell: two sweeps, exact for this metric."""
    rows, cols = walls.shape
    far = rows + cols
    clearance = np.empty((rows, cols), np.int32)
    for row in range(rows):
        for col in range(cols):
            nearest = 0 if walls[row, col] else far
            if row > 0:
                for other in range(max(col - 1, 0), min(col + 2, cols)):
                    nearest = min(nearest, clearance[row - 1, other] + 1)
            if col > 0:
                nearest = min(nearest, clearance[row, col - 1] + 1)
            clearance[row, col] = nearest
    for row in range(rows - 1, -1, -1):
        for col in range(cols - 1, -1, -1):
            nearest = clearance[row, col]
            if row < rows - 1:
                for other in range(max(col - 1, 0), min(col + 2, cols)):
                    nearest = min(nearest, clearance[row + 1, other] + 1)
            if col < cols - 1:
                nearest = min(nearest, clearance[row, col + 1] + 1)
            clearance[row, col] = nearest
    return clearance
