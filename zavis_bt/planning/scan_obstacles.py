"""Obstacles that a scan shows and the map does not. Lengths in cells, as in `grid_kernels`."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from zavis_bt.planning.distance_field import DistanceField
from zavis_bt.planning.grid_kernels import Body
from zavis_bt.types import FloatArray

_MAPPED = 1.5  # a scan point this near to an obstacle cell's centre belongs to it [cells]
_SPACING = 0.5  # neighbouring points closer than this count once [cells]
_OWN = 0.4  # points deeper inside the outline than this share of its inscribed radius are the robot's own parts


@njit(cache=True, nogil=True)
def unmapped(
    field: DistanceField,
    body: Body,
    pose: tuple[float, float, float],
    sensor: tuple[float, float, float],
    ranges: FloatArray,
    angle_min: float,
    angle_increment: float,
    range_min: float,
    reach: float,
) -> FloatArray:
    """Return the (n, 2) u, v of scan points within reach that no obstacle cell of the map explains.

    Args:
        field: Distances to mapped obstacles.
        body: The outline; points deep inside of it are left out.
        pose: u, v, yaw of the robot.
        sensor: u, v, yaw of the sensor.
        ranges: (n,) [cells].
        angle_min: Direction of the first beam [rad].
        angle_increment: [rad]
        range_min: Nearer returns are broken [cells].
        reach: Farther ones do not matter [cells].
    """
    rows, cols = field.distance.shape
    points, count = np.empty((len(ranges), 2)), 0
    for i in range(len(ranges)):
        if not range_min <= ranges[i] <= reach:
            continue
        angle = sensor[2] + angle_min + i * angle_increment
        u, v = sensor[0] + ranges[i] * math.cos(angle), sensor[1] + ranges[i] * math.sin(angle)
        row, col = math.floor(v + 0.5), math.floor(u + 0.5)
        if 0 <= row < rows and 0 <= col < cols and field.distance[row, col] <= _MAPPED:
            continue
        if count > 0 and math.hypot(points[count - 1, 0] - u, points[count - 1, 1] - v) < _SPACING:
            continue
        if _depth(body, pose, u, v) < _OWN * body.inner:
            points[count, 0], points[count, 1] = u, v
            count += 1
    return points[:count].copy()


@njit(cache=True, nogil=True)
def deepest(body: Body, pose: tuple[float, float, float], points: FloatArray) -> float:
    """Return how deep the deepest of (n, 2) points (u, v) lies inside the outline; negative if none does."""
    found = -math.inf
    for i in range(len(points)):
        found = max(found, _depth(body, pose, points[i, 0], points[i, 1]))
    return found


@njit(cache=True, nogil=True)
def _depth(body: Body, pose: tuple[float, float, float], u: float, v: float) -> float:
    """Return how deep a point lies inside the outline; negative if it is outside."""
    du, dv = u - pose[0], v - pose[1]
    if body.disc:
        return body.outer - math.hypot(du, dv)
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    ahead, aside = cos * du + sin * dv, cos * dv - sin * du
    return min(body.front - ahead, body.back + ahead, body.half_width - abs(aside))
