"""Whether a robot fits: at a pose, on a straight line. All lengths in cells, the centre of [row, col] at (col, row)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.planning.distance_field import DistanceField
from zavis_bt.types import FloatArray, Footprint

_TOUCH = 1e-6  # two things this close touch and do not overlap
_HALF_DIAGONAL = 0.7072


class Body(NamedTuple):
    """A robot's outline in cells, about the base's origin."""

    inner: float
    """Radius of the largest disc inside."""
    outer: float
    """Radius of the smallest disc around; equals `inner` for a disc."""
    disc: bool
    front: float
    back: float
    half_width: float

    @classmethod
    def of(cls, footprint: Footprint, resolution: float) -> Body:
        """Return the outline of a footprint in a grid of that resolution [m]."""
        half = footprint.length / 2
        return cls(
            footprint.inscribed_radius / resolution,
            footprint.circumscribed_radius / resolution,
            footprint.disc,
            (half + footprint.centre_x) / resolution,
            (half - footprint.centre_x) / resolution,
            footprint.width / 2 / resolution,
        )

    def scaled(self, factor: float) -> Body:
        """Return the outline shrunk or grown about the origin."""
        inner, outer, front, back, half_width = (
            factor * length for length in (self.inner, self.outer, self.front, self.back, self.half_width)
        )
        return Body(inner, outer, self.disc, front, back, half_width)

    def padded(self, margin: float) -> Body:
        """Return the outline with a margin around it."""
        outer = (
            self.outer + margin
            if self.disc
            else math.hypot(max(self.front, self.back) + margin, self.half_width + margin)
        )
        return Body(
            self.inner + margin, outer, self.disc, self.front + margin, self.back + margin, self.half_width + margin
        )


@njit(cache=True, nogil=True)
def clearance(field: DistanceField, u: float, v: float) -> float:
    """Return the distance from a point to the centre of the nearest obstacle cell.

    The nearest obstacles of the four cells around the point are compared, which gives the exact distance but for
    points whose nearest obstacle is nearest to none of those cells; then it is larger by a tiny fraction of a cell.
    Outside the grid it is 0 if the field is closed, else that of the nearest cells inside.
    """
    rows, cols = field.distance.shape
    col, row = math.floor(u), math.floor(v)
    if field.closed and (u < -0.5 or v < -0.5 or u > cols - 0.5 or v > rows - 0.5):
        return 0.0
    best = math.inf
    for r in (min(max(row, 0), rows - 1), min(max(row + 1, 0), rows - 1)):
        for c in (min(max(col, 0), cols - 1), min(max(col + 1, 0), cols - 1)):
            if field.distance[r, c] < math.inf:
                dv, du = field.nearest[r, c, 0] - v, field.nearest[r, c, 1] - u
                best = min(best, du * du + dv * dv)
    return math.sqrt(best)


@njit(cache=True, nogil=True)
def body_fits(field: DistanceField, body: Body, u: float, v: float, yaw: float) -> bool:
    """Return whether the outline at a pose holds no centre of an obstacle cell."""
    rows, cols = field.distance.shape
    row, col = math.floor(v + 0.5), math.floor(u + 0.5)
    if 0 <= row < rows and 0 <= col < cols and field.distance[row, col] >= body.outer + _HALF_DIAGONAL:
        return True
    free = clearance(field, u, v)
    if free >= body.outer - _TOUCH:
        return True
    if body.disc or free < body.inner - _TOUCH:
        return False
    return not _holds_obstacle(field, body, u, v, yaw)


@njit(cache=True, nogil=True)
def _holds_obstacle(field: DistanceField, body: Body, u: float, v: float, yaw: float) -> bool:
    rows, cols = field.obstacle.shape
    cos, sin = math.cos(yaw), math.sin(yaw)
    front, back, half_width = body.front - _TOUCH, body.back - _TOUCH, body.half_width - _TOUCH
    for row in range(math.ceil(v - body.outer), math.floor(v + body.outer) + 1):
        dv = row - v
        half = math.sqrt(max(body.outer * body.outer - dv * dv, 0.0))
        for col in range(math.ceil(u - half), math.floor(u + half) + 1):
            if 0 <= row < rows and 0 <= col < cols:
                if not field.obstacle[row, col]:
                    continue
            elif not field.closed:
                continue
            du = col - u
            if -back < cos * du + sin * dv < front and abs(cos * dv - sin * du) < half_width:
                return True
    return False


@njit(cache=True, nogil=True)
def largest_fit(field: DistanceField, body: Body, u: float, v: float, yaw: float) -> float:
    """Return the largest scale, at most 1, at which the outline at a pose holds no centre of an obstacle cell."""
    if body.disc:
        return min(1.0, clearance(field, u, v) / body.outer)
    rows, cols = field.obstacle.shape
    cos, sin = math.cos(yaw), math.sin(yaw)
    scale = 1.0
    for row in range(math.ceil(v - body.outer), math.floor(v + body.outer) + 1):
        for col in range(math.ceil(u - body.outer), math.floor(u + body.outer) + 1):
            if 0 <= row < rows and 0 <= col < cols:
                if not field.obstacle[row, col]:
                    continue
            elif not field.closed:
                continue
            du, dv = col - u, row - v
            ahead, aside = cos * du + sin * dv, abs(cos * dv - sin * du)
            depth = max(ahead / body.front if ahead > 0 else -ahead / body.back, aside / body.half_width)
            scale = min(scale, depth)
    return scale


@njit(cache=True, nogil=True)
def line_fits(
    field: DistanceField,
    barred: NDArray[np.bool_],
    radius: float,
    u0: float,
    v0: float,
    u1: float,
    v1: float,
) -> bool:
    """Return whether a disc can move along a straight line.

    Args:
        field: Distances to obstacles.
        barred: (rows, cols) cells where the disc's centre may not be, whatever its clearance.
        radius: Of the disc.
        u0: Start.
        v0: Start.
        u1: End.
        v1: End.

    Returns:
        Whether all cells that the line crosses are inside the grid and not barred, and no obstacle's centre is
        nearer to the line than the radius.
    """
    rows, cols = barred.shape
    row, col = math.floor(v0 + 0.5), math.floor(u0 + 0.5)
    row1, col1 = math.floor(v1 + 0.5), math.floor(u1 + 0.5)
    du, dv = u1 - u0, v1 - v0
    step_col, step_row = (1 if du > 0 else -1), (1 if dv > 0 else -1)
    # Line parameter at the next border between columns and between rows, and from border to border.
    per_col = 1.0 / abs(du) if du != 0.0 else math.inf
    per_row = 1.0 / abs(dv) if dv != 0.0 else math.inf
    next_col = (col + 0.5 * step_col - u0) / du if du != 0.0 else math.inf
    next_row = (row + 0.5 * step_row - v0) / dv if dv != 0.0 else math.inf
    close = (radius + _HALF_DIAGONAL) ** 2
    while True:
        if not (0 <= row < rows and 0 <= col < cols) or barred[row, col]:
            return False
        if field.distance[row, col] ** 2 < close and _line_near_obstacle(field, row, col, radius, u0, v0, du, dv):
            return False
        if row == row1 and col == col1:
            return True
        if next_col > 1.0 and next_row > 1.0:
            return True
        if next_col < next_row:
            col += step_col
            next_col += per_col
        else:
            row += step_row
            next_row += per_row


@njit(cache=True, nogil=True)
def _line_near_obstacle(
    field: DistanceField, row: int, col: int, radius: float, u0: float, v0: float, du: float, dv: float
) -> bool:
    """Return whether an obstacle that is nearest to the cell or to one of its neighbours is too near to the line."""
    rows, cols = field.distance.shape
    limit = (radius - _TOUCH) ** 2
    squared = du * du + dv * dv
    for index in range(5):
        r = row + (index == 1) - (index == 2)
        c = col + (index == 3) - (index == 4)
        if not (0 <= r < rows and 0 <= c < cols):
            continue
        ou, ov = field.nearest[r, c, 1] - u0, field.nearest[r, c, 0] - v0
        share = min(max((ou * du + ov * dv) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
        if (ou - share * du) ** 2 + (ov - share * dv) ** 2 < limit:
            return True
    return False


@njit(cache=True, nogil=True)
def polyline_fits(field: DistanceField, barred: NDArray[np.bool_], radius: float, points: FloatArray) -> bool:
    """Return whether a disc can move along the (n, 2) points (u, v)."""
    for i in range(len(points) - 1):
        if not line_fits(field, barred, radius, points[i, 0], points[i, 1], points[i + 1, 0], points[i + 1, 1]):
            return False
    return True


@njit(cache=True, nogil=True)
def clearances(field: DistanceField, points: FloatArray) -> FloatArray:
    """Return the (n,) clearances of (n, 2) points (u, v)."""
    result = np.empty(len(points))
    for i in range(len(points)):
        result[i] = clearance(field, points[i, 0], points[i, 1])
    return result


@njit(cache=True, nogil=True)
def nearest_passable(passable: NDArray[np.bool_], u: float, v: float, within: float) -> tuple[int, int]:
    """Return ``(row, col)`` of the passable cell whose centre is nearest to a point, or (-1, -1) if none is within."""
    rows, cols = passable.shape
    best, found = within * within, (-1, -1)
    for row in range(max(math.ceil(v - within), 0), min(math.floor(v + within), rows - 1) + 1):
        for col in range(max(math.ceil(u - within), 0), min(math.floor(u + within), cols - 1) + 1):
            squared = (col - u) ** 2 + (row - v) ** 2
            if passable[row, col] and squared < best:
                best, found = squared, (row, col)
    return found
