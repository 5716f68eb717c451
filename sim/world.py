"""A world to simulate: an occupancy map with furniture that has height, loose objects and places to start.

An occupied cell that touches a furniture box is furniture of that height; any other cell that is not free is wall.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import FREE, FloatArray, GridMap, Pose2D

if TYPE_CHECKING:
    from sim.raycast import RayCaster

_TOUCH = 1e-9  # [m] two edges this close touch
_EDGE = 1e-6  # [cells] a point this close to the edge of a cell is in the cells on both sides
_SHARED = ("occupied", "furniture_cells", "walls", "ray_caster")  # what depends on the map and the furniture alone


@dataclass(frozen=True, slots=True)
class Furniture:
    """A box that stands on the floor."""

    id: str
    category: str
    x: float
    """Centre [m]."""
    y: float
    """Centre [m]."""
    yaw: float
    """Direction of the length, counter-clockwise from x [rad]."""
    length: float
    """[m]"""
    width: float
    """[m]"""
    height: float
    """[m]"""
    colour: str | None = None
    """A colour's name; None leaves it to the furniture's look."""
    appearance: int | None = None
    """Seed of its look; None makes it follow from id and world."""


@dataclass(frozen=True, slots=True)
class WorldObject:
    """A loose thing that can be looked for.

    The position is the pivot of the asset it came from, which is its base or its centre, and the source does not say
    which. Treat the object as an axis-aligned box that stands on ``z``.
    """

    id: str
    category: str
    x: float
    y: float
    z: float
    size: tuple[float, float, float]
    """Extent along x, y and z of the map [m]."""
    on: str | None = None
    """Id of the furniture that bears it."""
    colour: str | None = None
    """A colour's name, for objects told apart by it."""
    appearance: int | None = None
    """Seed of its look; None makes it follow from id and world."""


@dataclass(frozen=True, eq=False)
class World:
    """A map, its furniture and its objects; immutable, arrays are read-only and derived when first asked for."""

    name: str
    grid: GridMap
    wall_height: float
    """[m]"""
    furniture: tuple[Furniture, ...] = ()
    objects: tuple[WorldObject, ...] = ()
    starts: tuple[Pose2D, ...] = ()
    path: Path | None = None
    """File it was loaded from."""

    @cached_property
    def occupied(self) -> NDArray[np.bool_]:
        """(rows, cols) cells that are not free: walls, furniture and what is unknown."""
        return _read_only(self.grid.states != FREE)

    @cached_property
    def furniture_cells(self) -> NDArray[np.bool_]:
        """(rows, cols) cells that are not free and touch a furniture box."""
        touched = np.zeros(self.grid.shape, dtype=np.bool_)
        for piece in self.furniture:
            mark_touched(touched, self.grid, piece)
        return _read_only(touched & self.occupied)

    @cached_property
    def walls(self) -> NDArray[np.bool_]:
        """(rows, cols) cells that are not free and that no furniture box touches."""
        return _read_only(self.occupied & ~self.furniture_cells)

    @cached_property
    def ray_caster(self) -> RayCaster:
        """Casts rays that every cell that is not free stops."""
        from sim.raycast import RayCaster  # brings the compiler, which readers of worlds do not need

        return RayCaster(self.occupied, self.grid.resolution, self.grid.origin)

    def with_objects(self, objects: Iterable[WorldObject]) -> World:
        """Return this world with other objects in it; the derived arrays are shared, not made anew."""
        world = replace(self, objects=tuple(objects))
        world.__dict__.update({name: getattr(self, name) for name in _SHARED})
        return world

    def fits(self, x: float, y: float, radius: float) -> bool:
        """Return whether a disc robot can stand at (x, y).

        The costmap convention: its centre, or the centre of a cell that holds it, is at least ``radius`` from the
        centre of every cell that is not free. What lies outside the map is not free.
        """
        resolution, (x0, y0) = self.grid.resolution, self.grid.origin
        u, v, reach = (x - x0) / resolution - 0.5, (y - y0) / resolution - 0.5, radius / resolution
        if self._clear(u, v, reach):
            return True
        cols = {math.floor(u + 0.5 - _EDGE), math.floor(u + 0.5 + _EDGE)}
        rows = {math.floor(v + 0.5 - _EDGE), math.floor(v + 0.5 + _EDGE)}
        return any(self._clear(col, row, reach) for col in cols for row in rows)

    def _clear(self, u: float, v: float, reach: float) -> bool:
        """Return whether no cell's centre that is not free is within reach of (u, v), all in cells."""
        cols = np.arange(math.ceil(u - reach), math.floor(u + reach) + 1)
        rows = np.arange(math.ceil(v - reach), math.floor(v + reach) + 1)
        near = (rows[:, None] - v) ** 2 + (cols - u) ** 2 < (reach - _TOUCH) ** 2
        return not bool((near & self._blocked(rows, cols)).any())

    def _blocked(self, rows: NDArray[np.intp], cols: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return (len(rows), len(cols)) which cells of the window are not free or outside."""
        height, width = self.grid.shape
        inside_rows, inside_cols = rows.clip(0, height - 1), cols.clip(0, width - 1)
        blocked: NDArray[np.bool_] = self.occupied[np.ix_(inside_rows, inside_cols)]
        blocked |= (rows != inside_rows)[:, None] | (cols != inside_cols)
        return blocked


def mark_touched(touched: NDArray[np.bool_], grid: GridMap, piece: Furniture) -> None:
    """Set the cells of ``touched`` (rows, cols) whose square touches the box of ``piece``."""
    cos, sin = math.cos(piece.yaw), math.sin(piece.yaw)
    half = grid.resolution / 2
    reach_x = (abs(cos) * piece.length + abs(sin) * piece.width) / 2 + half + _TOUCH
    reach_y = (abs(sin) * piece.length + abs(cos) * piece.width) / 2 + half + _TOUCH
    cols, x = _centres_within(piece.x, reach_x, grid.origin[0], grid.resolution, grid.shape[1])
    rows, y = _centres_within(piece.y, reach_y, grid.origin[1], grid.resolution, grid.shape[0])
    # Separating axes of a square and a box: x and y are done by the window, along and across remain.
    dx, dy = x - piece.x, (y - piece.y)[:, None]
    spread = half * (abs(cos) + abs(sin)) + _TOUCH
    along = np.abs(cos * dx + sin * dy) <= piece.length / 2 + spread
    across = np.abs(cos * dy - sin * dx) <= piece.width / 2 + spread
    touched[rows, cols] |= along & across


def _centres_within(
    centre: float, reach: float, origin: float, resolution: float, count: int
) -> tuple[slice, FloatArray]:
    """Return the cells of one axis whose centres are within reach of a coordinate, and those centres [m]."""
    first = max(math.ceil((centre - reach - origin) / resolution - 0.5), 0)
    last = min(math.floor((centre + reach - origin) / resolution - 0.5), count - 1)
    cells = np.arange(first, max(last + 1, first), dtype=np.float64)
    centres: FloatArray = (cells + 0.5) * resolution + origin
    return slice(first, max(last + 1, first)), centres


def _read_only(array: NDArray[np.bool_]) -> NDArray[np.bool_]:
    array.setflags(write=False)
    return array
