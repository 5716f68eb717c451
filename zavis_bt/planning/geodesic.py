"""Path lengths from one place to everywhere."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.planning.costmap import Costmap
from zavis_bt.planning.dijkstra import UNREACHED, dijkstra
from zavis_bt.planning.distance_field import DistanceField
from zavis_bt.planning.grid_kernels import line_fits
from zavis_bt.planning.steps import BORDER, steps_of
from zavis_bt.types import FloatArray, Pose2D

ESCAPE = 0.3  # a start where the robot does not fit may be this far from where it does [m]

_SNAP = 1.5  # a point may be this far from the passable cell that stands for it [cells]


class GeodesicField:
    """Lengths of the shortest paths from a start.

    Dijkstra's algorithm over the passable cells in 16 directions finds the way; the length is that of the way pulled
    taut, on average within 0.5 % of the geodesic distance.
    """

    def __init__(self, costmap: Costmap, start: Pose2D) -> None:
        """Compute the field.

        Args:
            costmap: Where the robot fits.
            start: Where the paths begin; where the robot does not fit there, with a straight line of at most `ESCAPE`
                to the nearest passable cell. If there is none, nothing is reachable.
        """
        self.start = start
        self._costmap = costmap
        self._width = costmap.grid.shape[1] + 2 * BORDER
        cell = costmap.nearest_passable(start.x, start.y, ESCAPE)
        self._source = -1 if cell is None else (cell[0] + BORDER) * self._width + cell[1] + BORDER
        self._steps, self._parent = dijkstra(costmap.open_steps, steps_of(self._width), self._source)
        self._anchor = np.full(len(self._parent), -1, dtype=np.int32)
        self._taut = np.full(len(self._parent), math.inf)

    @property
    def reachable(self) -> NDArray[np.bool_]:
        """(rows, cols) cells to which there is a path."""
        steps = self._steps.reshape(-1, self._width)[BORDER:-BORDER, BORDER:-BORDER]
        reached: NDArray[np.bool_] = steps < UNREACHED
        return reached

    def reaches(self, points: FloatArray) -> NDArray[np.bool_]:
        """Tell to which of (n, 2) points [m] there is a path; cheaper than their distances."""
        uv = self._costmap.to_uv(np.reshape(np.asarray(points, dtype=np.float64), (-1, 2)))
        cells: NDArray[np.intp] = _cells_for(self._steps, self._width, self._costmap.grid.shape, uv)
        return cells >= 0

    def distances(self, points: FloatArray) -> FloatArray:
        """Return the (n,) path lengths to (n, 2) points [m]; inf where there is no path."""
        uv = self._costmap.to_uv(np.reshape(np.asarray(points, dtype=np.float64), (-1, 2)))
        ((u, v),) = self._costmap.to_uv(np.array([[self.start.x, self.start.y]]))
        resolution = self._costmap.grid.resolution
        lengths: FloatArray = _taut_lengths(
            self._costmap.field,
            self._costmap.barred,
            self._costmap.radius / resolution,
            self._steps,
            self._parent,
            self._anchor,
            self._taut,
            self._width,
            (u, v),
            uv,
        )
        return lengths * resolution


@njit(cache=True, nogil=True)
def _taut_lengths(
    field: DistanceField,
    barred: NDArray[np.bool_],
    radius: float,
    steps: NDArray[np.int32],
    parent: NDArray[np.int32],
    anchor: NDArray[np.int32],
    taut: FloatArray,
    width: int,
    start: tuple[float, float],
    points: FloatArray,
) -> FloatArray:
    """Return the (n,) taut lengths [cells] of the ways to (n, 2) points (u, v).

    ``anchor`` and ``taut`` keep what is known of a cell: the last corner of its way (-1: none yet) and the length. They
    are filled from the start outwards, so that ways which share a part share the work.
    """
    lengths = np.full(len(points), math.inf)
    chain = np.empty(len(steps), dtype=np.int32)
    for i in range(len(points)):
        u, v = points[i]
        cell = _cell_for(steps, width, barred.shape, u, v)
        if cell < 0:
            continue
        count, walk = 0, cell
        while walk >= 0 and anchor[walk] < 0:
            chain[count] = walk
            count += 1
            walk = parent[walk]
        for k in range(count - 1, -1, -1):
            _pull(field, barred, radius, parent, anchor, taut, width, start, chain[k])
        lengths[i] = _last_leg(field, barred, radius, anchor, taut, width, start, cell, u, v)
    return lengths


@njit(cache=True, nogil=True)
def _cells_for(steps: NDArray[np.int32], width: int, shape: tuple[int, int], points: FloatArray) -> NDArray[np.intp]:
    """Return the (n,) reached cells that stand for (n, 2) points (u, v), -1 where there is none."""
    cells = np.empty(len(points), dtype=np.intp)
    for i in range(len(points)):
        cells[i] = _cell_for(steps, width, shape, points[i, 0], points[i, 1])
    return cells


@njit(cache=True, nogil=True)
def _cell_for(steps: NDArray[np.int32], width: int, shape: tuple[int, int], u: float, v: float) -> int:
    """Return the reached cell that stands for a point, or -1."""
    rows, cols = shape
    best, found = _SNAP * _SNAP, -1
    for row in range(max(math.ceil(v - _SNAP), 0), min(math.floor(v + _SNAP), rows - 1) + 1):
        for col in range(max(math.ceil(u - _SNAP), 0), min(math.floor(u + _SNAP), cols - 1) + 1):
            cell = (row + BORDER) * width + col + BORDER
            squared = (col - u) ** 2 + (row - v) ** 2
            if steps[cell] < UNREACHED and squared < best:
                best, found = squared, cell
    return found


@njit(cache=True, nogil=True)
def _pull(
    field: DistanceField,
    barred: NDArray[np.bool_],
    radius: float,
    parent: NDArray[np.int32],
    anchor: NDArray[np.int32],
    taut: FloatArray,
    width: int,
    start: tuple[float, float],
    cell: int,
) -> None:
    """Set a cell's anchor and length from those of the cell before it."""
    row, col = cell // width - BORDER, cell % width - BORDER
    before = parent[cell]
    if before < 0:  # the start's cell is its own anchor and stands for the start itself
        anchor[cell] = cell
        taut[cell] = math.hypot(col - start[0], row - start[1])
        return
    corner = anchor[before]
    u, v, length = _corner(parent, taut, width, start, corner)
    if line_fits(field, barred, radius, u, v, col, row):
        anchor[cell] = corner
    else:
        anchor[cell] = before
        u, v, length = _corner(parent, taut, width, start, before)
        if parent[before] < 0:  # the way leaves the start through the middle of its cell
            u, v, length = before % width - BORDER, before // width - BORDER, taut[before]
    taut[cell] = length + math.hypot(col - u, row - v)


@njit(cache=True, nogil=True)
def _corner(
    parent: NDArray[np.int32], taut: FloatArray, width: int, start: tuple[float, float], cell: int
) -> tuple[float, float, float]:
    """Return position and length of a corner; the start's cell stands for the start."""
    if parent[cell] < 0:
        return start[0], start[1], 0.0
    return float(cell % width - BORDER), float(cell // width - BORDER), taut[cell]


@njit(cache=True, nogil=True)
def _last_leg(
    field: DistanceField,
    barred: NDArray[np.bool_],
    radius: float,
    anchor: NDArray[np.int32],
    taut: FloatArray,
    width: int,
    start: tuple[float, float],
    cell: int,
    u: float,
    v: float,
) -> float:
    """Return the length to a point by the way to its cell."""
    row, col = cell // width - BORDER, cell % width - BORDER
    by_cell: float = taut[cell] + math.hypot(u - col, v - row)
    corner = anchor[cell]
    if corner == cell or anchor[corner] == corner:
        cu, cv, length = start[0], start[1], 0.0
    else:
        cu, cv, length = float(corner % width - BORDER), float(corner // width - BORDER), taut[corner]
    if line_fits(field, barred, radius, cu, cv, u, v):
        return min(by_cell, length + math.hypot(u - cu, v - cv))
    return by_cell
