"""One LiDAR scan into a grid of log-odds, every cell at most once."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.mapping.scanline import polygon_spans
from zavis_bt.mapping.visible_area import HIT, Beams, corners, free_outline

LogOddsArray = NDArray[np.float32]
Cells = tuple[NDArray[np.int64], NDArray[np.float32]]
"""Flat indices of cells, and their values before the scan."""

# A surface lies on the far side of its hit, so its cell is looked up behind the hit, past the noise of the reading;
# at the rim of a thing, where it may be thin, only just behind [cells].
_BEHIND_SURFACE, _BEHIND_RIM = 0.4, 0.05
_LONGEST_STRETCH = 64  # of surface between two hits [cells]


class SensorModel(NamedTuple):
    """What a reading is worth, in log-odds of a cell being occupied."""

    hit: float = 0.9
    """For the cell a beam ended in."""
    miss: float = -0.4
    """For a cell the beams leave no room to hide in, or that a beam went through."""
    gap: float = -0.3
    """Floor for cells between beams further apart than a cell: they become free if nothing was ever seen there, but
    a thin thing between two beams is no less there for having been missed."""
    surface: float = 0.3
    """Floor for cells between neighbouring hits on one surface, unless they were seen to be free: a wall whose cells
    are only hit here and there, being far or seen at a flat angle, is closed all the same until a closer look."""
    low: float = -2.0
    """Least value, so that what changes is noticed soon."""
    high: float = 3.5
    """Greatest value."""


@njit(cache=True)
def update(
    log_odds: LogOddsArray,
    x: float,
    y: float,
    beams: Beams,
    step: float,
    cell: float,
    model: SensorModel,
) -> None:
    """Fuse a scan whose beams all end inside the grid.

    Hits win over misses; so does the stretch of surface between two hits, since beams that graze a wall pass
    through cells which the wall fills only in part.

    Args:
        log_odds: (rows, cols), changed in place.
        x: Sensor [cells].
        y: Sensor [cells].
        beams: From `trace`.
        step: Angle between neighbouring beams [rad].
        cell: Side of a cell [m].
        model: Weights of hits and misses.
    """
    cos, sin, reach, kinds = beams
    rows, cols = log_odds.shape
    dense = cell / abs(step)  # up to this distance neighbouring beams are at most a cell apart
    outline = free_outline(reach, step, cell)
    points = _surface_points(x, y, beams, outline, cell)
    hits, before_hits = _hit_cells(log_odds, points, kinds)
    surface, before_surface = _surface_cells(log_odds, points, beams, outline)

    xs, ys = corners(outline, dense, cos, sin, x, y, cell)
    offsets, columns = polygon_spans(xs, ys, rows, cols)
    _lower(log_odds, offsets, columns, model.miss, model.low)
    _follow_beams(log_odds, x, y, beams, outline, dense, cell, model)
    if reach.max() > dense:
        xs, ys = corners(outline, np.inf, cos, sin, x, y, cell)
        offsets, columns = polygon_spans(xs, ys, rows, cols)
        _open(log_odds, offsets, columns, model.gap)

    flat = log_odds.reshape(-1)
    for i in range(len(surface)):
        seen_free = before_surface[i] < 0
        flat[surface[i]] = before_surface[i] if seen_free else max(before_surface[i], np.float32(model.surface))
    for i in range(len(hits)):
        flat[hits[i]] = min(before_hits[i] + model.hit, model.high)


@njit(cache=True)
def _surface_points(x: float, y: float, beams: Beams, outline: NDArray[np.float64], cell: float) -> NDArray[np.float64]:
    """Return (n, 2) x and y of points just behind where the beams ended [cells]."""
    cos, sin, reach, _kinds = beams
    points = np.empty((len(reach), 2))
    for i in range(len(reach)):
        goes_on = reach[i] > 0 and outline[i, 0] == reach[i] and outline[i - 1, 1] == reach[i]
        distance = reach[i] / cell + (_BEHIND_SURFACE if goes_on else _BEHIND_RIM)
        points[i, 0], points[i, 1] = x + distance * cos[i], y + distance * sin[i]
    return points


@njit(cache=True)
def _hit_cells(log_odds: LogOddsArray, points: NDArray[np.float64], kinds: NDArray[np.int8]) -> Cells:
    """Find the cells the beams ended in, repeated if hit twice."""
    flat, cols = log_odds.reshape(-1), log_odds.shape[1]
    cells = np.empty(len(points), dtype=np.int64)
    k = 0
    for i in range(len(points)):
        if kinds[i] == HIT:
            cells[k] = int(points[i, 1]) * cols + int(points[i, 0])
            k += 1
    return cells[:k], flat[cells[:k]]


@njit(cache=True)
def _surface_cells(
    log_odds: LogOddsArray, points: NDArray[np.float64], beams: Beams, outline: NDArray[np.float64]
) -> Cells:
    """Find the cells between neighbouring hits on one surface."""
    _cos, _sin, reach, kinds = beams
    flat, cols, n = log_odds.reshape(-1), log_odds.shape[1], len(reach)
    cells = np.empty(n * _LONGEST_STRETCH, dtype=np.int64)
    k = 0
    for i in range(n):
        j = (i + 1) % n
        if kinds[i] != HIT or kinds[j] != HIT or outline[i, 0] != reach[i] or outline[i, 1] != reach[j]:
            continue  # there may be a shadow between them
        x, y = points[i, 0], points[i, 1]
        dx, dy = points[j, 0] - x, points[j, 1] - y
        steps = min(int(max(abs(dx), abs(dy))) + 1, _LONGEST_STRETCH)
        for s in range(1, steps):
            cells[k] = int(y + dy * s / steps) * cols + int(x + dx * s / steps)
            k += 1
    return cells[:k], flat[cells[:k]]


@njit(cache=True)
def _lower(
    log_odds: LogOddsArray, offsets: NDArray[np.int64], columns: NDArray[np.int64], miss: float, low: float
) -> None:
    """Count a miss for every cell of the spans."""
    loss, least = np.float32(miss), np.float32(low)  # single precision throughout: twice the cells an instruction
    for row in range(len(offsets) - 1):
        for k in range(offsets[row], offsets[row + 1] - 1, 2):
            values = log_odds[row, columns[k] : columns[k + 1]]
            for i in range(len(values)):
                lowered = values[i] + loss
                values[i] = lowered if lowered > least else least


@njit(cache=True)
def _open(log_odds: LogOddsArray, offsets: NDArray[np.int64], columns: NDArray[np.int64], gap: float) -> None:
    """Make the cells of the spans free that nothing speaks against; doing so twice changes nothing."""
    zero, floor = np.float32(0), np.float32(gap)
    for row in range(len(offsets) - 1):
        for k in range(offsets[row], offsets[row + 1] - 1, 2):
            values = log_odds[row, columns[k] : columns[k + 1]]
            for i in range(len(values)):
                value = values[i]
                values[i] = floor if (value <= zero) & (value > floor) else value


@njit(cache=True)
def _follow_beams(
    log_odds: LogOddsArray,
    x: float,
    y: float,
    beams: Beams,
    outline: NDArray[np.float64],
    dense: float,
    cell: float,
    model: SensorModel,
) -> None:
    """Take in the cells that single beams went through outside the area between the beams.

    Beyond the dense part of the scan beams lie at least a cell apart, so each counts a miss. Nearer, where many may
    cross one cell, they only make it free if nothing speaks against.
    """
    cos, sin, reach, kinds = beams
    for i in range(len(reach)):
        begin = max(outline[i, 0], outline[i - 1, 1])
        end = reach[i] - (cell if kinds[i] == HIT else 0.0)
        if begin < dense:
            _walk(log_odds, x, y, cos[i], sin[i], begin / cell, min(end, dense) / cell, model.gap, model.gap)
        if dense < end:
            _walk(log_odds, x, y, cos[i], sin[i], dense / cell + 1.0, end / cell, model.miss, model.low)


@njit(cache=True)
def _walk(
    log_odds: LogOddsArray,
    x: float,
    y: float,
    cos: float,
    sin: float,
    begin: float,
    end: float,
    change: float,
    least: float,
) -> None:
    """Lower the cells along a beam; occupied ones stay if the change is also the least value.

    One cell for each step along the longer axis: the one whose middle the beam comes nearest to, so that beams
    which only cut a corner say nothing.
    """
    loss, low = np.float32(change), np.float32(least)
    highest = np.float32(0) if change == least else np.float32(np.inf)
    upright = abs(sin) > abs(cos)
    major, minor = (sin, cos) if upright else (cos, sin)
    along, across = (y, x) if upright else (x, y)
    sign = 1 if major > 0 else -1
    first = math.floor(along + begin * major) + sign
    position = across + (first + 0.5 - along) * minor / major
    slope = minor / abs(major)
    stride_along, stride_across = (log_odds.shape[1], 1) if upright else (1, log_odds.shape[1])
    flat = log_odds.reshape(-1)
    for k in range(int((end - begin) * abs(major))):
        index = (first + k * sign) * stride_along + int(position + k * slope) * stride_across
        value = flat[index]
        if low < value <= highest:
            flat[index] = max(value + loss, low)
