"""Whether a robot's outline is free of obstacles, by the costmap convention.

A disc is free where its centre, or the centre of a cell that holds it, is at least its radius from the centre of every
cell that is not free: so a path through cells that are passable by that rule never collides, wherever in the cells it
runs. A rectangle is free where no such centre lies inside of it. What is outside the map is not free. Lengths are in
cells, the centre of cell [row, col] is at (col, row).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.types import Footprint

_TOUCH = 1e-9  # two things this close touch and do not overlap
_EDGE = 1e-6  # a point this close to the edge of a cell is in the cells on both sides


class Body(NamedTuple):
    """An outline in cells, about the base's origin."""

    reach: float
    """Radius of the disc, or of the smallest circle around the rectangle."""
    disc: bool
    front: float
    back: float
    half_width: float

    @classmethod
    def of(cls, footprint: Footprint, resolution: float) -> Body:
        """Return the outline of a footprint in a grid of that resolution [m]."""
        half = footprint.length / 2
        return cls(
            footprint.circumscribed_radius / resolution,
            footprint.disc,
            (half + footprint.centre_x) / resolution,
            (half - footprint.centre_x) / resolution,
            footprint.width / 2 / resolution,
        )


@njit(cache=True, nogil=True)
def is_free(occupied: NDArray[np.bool_], body: Body, u: float, v: float, yaw: float) -> bool:
    """Return whether the body can be at (u, v) in cells, heading to yaw."""
    if not body.disc:
        return _rectangle_is_free(occupied, body, u, v, yaw)
    if _disc_is_free(occupied, body.reach, u, v):
        return True
    for row in range(math.floor(v + 0.5 - _EDGE), math.floor(v + 0.5 + _EDGE) + 1):
        for col in range(math.floor(u + 0.5 - _EDGE), math.floor(u + 0.5 + _EDGE) + 1):
            if _disc_is_free(occupied, body.reach, float(col), float(row)):
                return True
    return False


@njit(cache=True, nogil=True)
def _disc_is_free(occupied: NDArray[np.bool_], radius: float, u: float, v: float) -> bool:
    rows, cols = occupied.shape
    limit = (radius - _TOUCH) ** 2
    for row in range(math.ceil(v - radius), math.floor(v + radius) + 1):
        half = math.sqrt(max(limit - (row - v) ** 2, 0.0))
        for col in range(math.ceil(u - half), math.floor(u + half) + 1):
            free = 0 <= row < rows and 0 <= col < cols and not occupied[row, col]
            if not free and (col - u) ** 2 + (row - v) ** 2 < limit:
                return False
    return True


@njit(cache=True, nogil=True)
def _rectangle_is_free(occupied: NDArray[np.bool_], body: Body, u: float, v: float, yaw: float) -> bool:
    rows, cols = occupied.shape
    cos, sin = math.cos(yaw), math.sin(yaw)
    for row in range(math.ceil(v - body.reach), math.floor(v + body.reach) + 1):
        for col in range(math.ceil(u - body.reach), math.floor(u + body.reach) + 1):
            if 0 <= row < rows and 0 <= col < cols and not occupied[row, col]:
                continue
            ahead, aside = cos * (col - u) + sin * (row - v), cos * (row - v) - sin * (col - u)
            if -body.back + _TOUCH < ahead < body.front - _TOUCH and abs(aside) < body.half_width - _TOUCH:
                return False
    return True
