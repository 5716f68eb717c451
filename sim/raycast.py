"""Exact ray casting in an occupancy grid.

For every cell and each of the four quadrants of direction a table holds the side of the largest square of free cells
that has the cell in its corner and lies towards the quadrant. A ray leaps from cell to cell over these squares; beside
an obstacle the leap is one cell, so a hit is the exact crossing of the ray with the cell's edge.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.types import FloatArray

_MAX_LEAP = 255  # cells; the table is uint8, small enough to stay in the cache


class RayCaster:
    """Casts rays in one grid; the table is made once."""

    def __init__(self, occupied: NDArray[np.bool_], resolution: float, origin: tuple[float, float]) -> None:
        """Prepare a grid.

        Args:
            occupied: (rows, cols) cells that stop a ray; row 0 at the smallest y.
            resolution: Side of a cell [m].
            origin: Outer corner of cell [0, 0] [m].
        """
        self._leaps = _free_squares(np.ascontiguousarray(occupied, dtype=np.bool_))
        self._leaps.setflags(write=False)
        self._resolution = resolution
        self._origin = origin

    def cast(self, x: float, y: float, angles: FloatArray, range_max: float) -> FloatArray:
        """Return how far rays from a point reach.

        Args:
            x: Start of the rays [m].
            y: Start of the rays [m].
            angles: (n,) directions in the map [rad].
            range_max: [m]

        Returns:
            (n,) distances to the first occupied cell square [m]; 0 from inside one; +inf where there is none within
            ``range_max`` or the ray leaves the grid first. From outside the grid all are +inf.
        """
        u = (x - self._origin[0]) / self._resolution
        v = (y - self._origin[1]) / self._resolution
        directions = np.ascontiguousarray(angles, dtype=np.float64)
        ranges: FloatArray = _cast(self._leaps, u, v, directions, range_max / self._resolution, self._resolution)
        return ranges

    def sweep(
        self, x: float, y: float, first_angle: float, increment: float, count: int, range_max: float
    ) -> FloatArray:
        """Return ``cast`` for ``count`` evenly spaced directions: beam i looks along first + i · increment [rad]."""
        return self.cast(x, y, first_angle + increment * np.arange(count, dtype=np.float64), range_max)


@njit(cache=True, nogil=True)
def _free_squares(occupied: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return (4, rows, cols) sides of free squares; plane 0 towards +x +y, 1 towards −x +y, 2 +x −y, 3 −x −y."""
    rows, cols = occupied.shape
    sides = np.zeros((4, rows, cols), dtype=np.uint8)
    for quadrant in range(4):
        step_col = 1 if quadrant % 2 == 0 else -1
        step_row = 1 if quadrant < 2 else -1
        for i in range(rows):
            row = rows - 1 - i if step_row > 0 else i
            for j in range(cols):
                col = cols - 1 - j if step_col > 0 else j
                if occupied[row, col]:
                    continue
                side = 0
                if i > 0 and j > 0:
                    ahead, beside = sides[quadrant, row + step_row, col], sides[quadrant, row, col + step_col]
                    side = min(ahead, beside, sides[quadrant, row + step_row, col + step_col])
                sides[quadrant, row, col] = min(side + 1, _MAX_LEAP)
    return sides


@njit(cache=True, nogil=True)
def _component(value: float) -> float:
    """Return a component of a direction, without those whose inverse is not finite."""
    return value if abs(value) > 1e-200 else 0.0


@njit(cache=True, nogil=True)
def _cast(
    leaps: NDArray[np.uint8], u: float, v: float, angles: FloatArray, reach: float, resolution: float
) -> FloatArray:
    """Cast rays from (u, v) in cells; ``reach`` in cells, result in metres."""
    rows, cols = leaps.shape[1], leaps.shape[2]
    ranges = np.full(angles.size, np.inf)
    first_col, first_row = math.floor(u), math.floor(v)
    if not (0 <= first_col < cols and 0 <= first_row < rows):
        return ranges
    for beam in range(angles.size):
        du, dv = _component(math.cos(angles[beam])), _component(math.sin(angles[beam]))
        quadrant = (1 if du < 0 else 0) + (2 if dv < 0 else 0)
        inverse_u = 1.0 / du if du != 0.0 else np.inf
        inverse_v = 1.0 / dv if dv != 0.0 else np.inf
        col, row, travelled = first_col, first_row, 0.0
        while travelled <= reach:
            side = int(leaps[quadrant, row, col])
            if side == 0:
                ranges[beam] = travelled * resolution
                break
            edge_u = col + side if du >= 0 else col + 1 - side
            edge_v = row + side if dv >= 0 else row + 1 - side
            to_u, to_v = (edge_u - u) * inverse_u, (edge_v - v) * inverse_v
            # Leave the square across the nearer edge; rounding must not put the other coordinate outside of it.
            if to_u <= to_v:
                travelled = to_u
                across = math.floor(v + dv * to_u)
                row = min(max(across, row), edge_v - 1) if dv >= 0 else max(min(across, row), edge_v)
                col = edge_u if du >= 0 else edge_u - 1
            else:
                travelled = to_v
                across = math.floor(u + du * to_v)
                col = min(max(across, col), edge_u - 1) if du >= 0 else max(min(across, col), edge_u)
                row = edge_v if dv >= 0 else edge_v - 1
            if not (0 <= col < cols and 0 <= row < rows):
                break
    return ranges
