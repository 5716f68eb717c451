"""A world as the camera sees it: boxes, walls and a floor, and how they look."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.appearance.dress import dress
from sim.appearance.look import Look
from sim.appearance.room import RoomLook
from sim.render_parts import Parts, wall_faces
from sim.render_rays import CARRIES, COS, CX, HX, SIN, WALL_SLACK, IntArray, Solids
from sim.world import Furniture, World, WorldObject
from zavis_bt.types import FloatArray

_HULL_TOLERANCE = 0.05  # [m] by which an object's centre may stick out of the furniture that holds it


@dataclass(frozen=True, eq=False)
class Scene:
    """What can be seen of a world. Box i is `things` [i]; what is only needed for pictures is made when asked for."""

    world: World
    room: RoomLook
    solids: Solids

    @classmethod
    def of(cls, world: World, room: RoomLook | None = None) -> Scene:
        """Return the scene of a world.

        Args:
            world: What there is; see `sim.render_rays` for what hides what.
            room: How walls, floor and light look; bright and plain if None.
        """
        boxes = _boxes(world)
        hulls = _hulls(world, boxes)
        boxes[hulls[hulls >= 0], CARRIES] = 1.0
        (x, y), grid = world.grid.origin, world.grid
        measures = np.array([x, y, grid.resolution, world.wall_height], dtype=np.float64)
        solids = Solids(boxes, hulls, _clearance(np.ascontiguousarray(world.walls)), measures)
        for array in solids:
            array.setflags(write=False)
        return cls(world, room or RoomLook(), solids)

    @property
    def furniture(self) -> tuple[Furniture, ...]:
        """The first of the things."""
        return self.world.furniture

    @property
    def things(self) -> tuple[Furniture | WorldObject, ...]:
        """What each box is: after the furniture come the objects."""
        return self.world.furniture + self.world.objects

    @property
    def parts(self) -> Parts:
        """What the camera sees of the things."""
        return self._dressed[0]

    @property
    def looks(self) -> tuple[Look, ...]:
        """What was drawn for each thing."""
        return self._dressed[1]

    @cached_property
    def room_paint(self) -> FloatArray:
        """Look of the room, as `sim.render_shade` has it."""
        return self.room.columns()

    @cached_property
    def wall_faces(self) -> FloatArray:
        """(w, 4) see `sim.render_parts.wall_faces`."""
        faces = wall_faces(self.world.walls, self.world.grid.resolution, self.world.grid.origin)
        faces.setflags(write=False)
        return faces

    @cached_property
    def _dressed(self) -> tuple[Parts, tuple[Look, ...]]:
        return dress(self.world, self.room_paint)


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
