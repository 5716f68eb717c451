"""What a LiDAR scan says: the outline of the area it saw to be free, and where surfaces are."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

BROKEN, OPEN, HIT = 0, 1, 2  # what became of a beam: no reading, nothing within reach, a surface

Beams = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.int8]]
"""(n,) cosines and sines in the map, (n,) reach [m] (0 for a broken beam), (n,) `BROKEN`, `OPEN` or `HIT`."""

_WIDEST = 0.26  # beams further apart than 15° say nothing about the area between them [rad]
_STEEPEST = 5.7  # 1 / tan 10°: a surface seen at a flatter angle than 10° is not told from a jump in depth


@njit(cache=True, nogil=True)
def trace(
    ranges: NDArray[np.float64], angle: float, step: float, range_min: float, limit: float, open_free: bool
) -> Beams:
    """Sort out the beams of a scan.

    Args:
        ranges: (n,) [m].
        angle: Direction of the first beam, map frame [rad].
        step: Angle between neighbouring beams [rad].
        range_min: Readings below are broken [m].
        limit: Readings above say only that there is nothing up to here [m].
        open_free: Whether a beam without return says so too; else it counts as broken.

    Returns:
        The beams.
    """
    n = len(ranges)
    cos, sin, reach = np.empty(n), np.empty(n), np.zeros(n)
    kinds = np.zeros(n, dtype=np.int8)
    for i in range(n):
        cos[i], sin[i] = math.cos(angle + i * step), math.sin(angle + i * step)
        if ranges[i] >= range_min and (open_free or ranges[i] < np.inf):  # false for NaN
            kinds[i] = HIT if ranges[i] <= limit else OPEN
            reach[i] = min(ranges[i], limit)
    return cos, sin, reach, kinds


@njit(cache=True, inline="always")
def is_jump(a: float, b: float, step: float, cell: float) -> bool:
    """Tell whether neighbouring reaches differ by more than a surface seen at 10° explains."""
    return abs(b - a) > _STEEPEST * min(a, b) * abs(step) + cell


@njit(cache=True, inline="always")
def same_surface(before: float, a: float, b: float, after: float, step: float, cell: float) -> bool:
    """Tell whether the surface goes on between neighbouring beams of reach a and b, or there may be a shadow.

    Equal ranges belong together. So do ranges on a straight line: 1/r of a line obeys
    1/r(θ + δ) = 2 cos δ / r(θ) − 1/r(θ − δ), which the beam before or the beam after confirms.

    Args:
        before: Reach of the beam before a [m], 0 if none.
        a: Reach [m].
        b: Reach of the next beam [m].
        after: Reach of the beam after b [m], 0 if none.
        step: Angle between the beams [rad].
        cell: Side of a cell [m].
    """
    jump, gap = abs(b - a), min(a, b) * abs(step)
    if min(a, b) <= 0 or is_jump(a, b, step, cell):
        return False
    if jump <= max(gap, cell):
        return True
    tolerance = max(1.5 * cell, 0.2 * jump)
    return _on_line(before, a, b, step, tolerance) or _on_line(after, b, a, step, tolerance)


@njit(cache=True, inline="always")
def _on_line(first: float, second: float, third: float, step: float, tolerance: float) -> bool:
    if first <= 0:
        return False
    inverse = 2 * math.cos(step) / second - 1 / first
    return inverse > 0 and abs(1 / inverse - third) <= tolerance


@njit(cache=True, nogil=True)
def free_outline(reach: NDArray[np.float64], step: float, cell: float) -> NDArray[np.float64]:
    """Return how far the area between neighbouring beams is free.

    Along a surface that goes on, the area ends at the chord between the two ends; where there may be a shadow it
    ends at the shorter of the two beams.

    Args:
        reach: (n,) [m], 0 for a broken beam.
        step: Angle between neighbouring beams [rad].
        cell: Side of a cell [m].

    Returns:
        (n, 2) reach on beam i and on beam i + 1 of the area between them [m]; the last row is 0 unless the beams
        close a circle.
    """
    n = len(reach)
    circle = n > 2 and abs(abs(step) * n - math.tau) < abs(step) / 2
    outline = np.zeros((n, 2))
    if abs(step) > _WIDEST:
        return outline
    for i in range(n if circle else n - 1):
        a, b = reach[i], reach[(i + 1) % n]
        before = reach[i - 1] if i > 0 or circle else 0.0
        after = reach[(i + 2) % n] if i + 2 < n or circle else 0.0
        if same_surface(before, a, b, after, step, cell):
            outline[i, 0], outline[i, 1] = a, b
        else:
            outline[i, 0] = outline[i, 1] = min(a, b)
    return outline


@njit(cache=True, nogil=True)
def corners(
    outline: NDArray[np.float64],
    limit: float,
    cos: NDArray[np.float64],
    sin: NDArray[np.float64],
    x: float,
    y: float,
    cell: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the polygon of the free area up to a distance.

    Args:
        outline: (n, 2) from `free_outline` [m].
        limit: Nothing further away is wanted [m].
        cos: (n,) of the beams.
        sin: (n,) of the beams.
        x: Sensor [cells].
        y: Sensor [cells].
        cell: Side of a cell [m].

    Returns:
        (2n,) x and y of the corners [cells].
    """
    n = len(outline)
    xs, ys = np.empty(2 * n), np.empty(2 * n)
    for i in range(n):
        after = (i + 1) % n
        a, b = min(outline[i, 0], limit) / cell, min(outline[i, 1], limit) / cell
        xs[2 * i], ys[2 * i] = x + a * cos[i], y + a * sin[i]
        xs[2 * i + 1], ys[2 * i + 1] = x + b * cos[after], y + b * sin[after]
    return xs, ys
