"""Whether a robot's outline is free of obstacles, by the costmap convention.

A disc is free where its centre is at least its radius from the centre of every cell that is not free; a rectangle
where no such centre lies inside of it. What is outside the map is not free. Lengths are in cells, the centre of cell
[row, col] is at (col, row).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.types import Footprint

_TOUCH = 1e-9  # two things this close touch and do not overlap


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


@njit(cache=True)
def is_free(occupied: NDArray[np.bool_], body: Body, u: float, v: float, yaw: float) -> bool:
    """Return whether the body can be at (u, v) in cells, heading to yaw."""
    rows, cols = occupied.shape
    cos, sin = math.cos(yaw), math.sin(yaw)
    for row in range(math.ceil(v - body.reach), math.floor(v + body.reach) + 1):
        dv = row - v
        half = math.sqrt(max(body.reach * body.reach - dv * dv, 0.0))
        for col in range(math.ceil(u - half), math.floor(u + half) + 1):
            if 0 <= row < rows and 0 <= col < cols and not occupied[row, col]:
                continue
            du = col - u
            if body.disc:
                if du * du + dv * dv < (body.reach - _TOUCH) ** 2:
                    return False
                continue
            ahead, aside = cos * du + sin * dv, cos * dv - sin * du
            if -body.back + _TOUCH < ahead < body.front - _TOUCH and abs(aside) < body.half_width - _TOUCH:
                return False
    return True
