"""One LiDAR scan into a grid of log-odds, every cell at most once."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.mapping.scan_misses import LogOddsArray, follow_beams, lower, lower_crossed, lower_unopposed
from zavis_bt.mapping.scanline import polygon_spans
from zavis_bt.mapping.sensor_model import SensorModel
from zavis_bt.mapping.visible_area import HIT, Beams, corners, free_outline

Cells = tuple[NDArray[np.int64], NDArray[np.float32]]
"""Flat indices of cells, and their values before the scan."""

# A surface lies on the far side of its hit, so its cell is looked up behind the hit, past the noise of the reading;
# at the rim of a thing, where it may be thin, only just behind [cells].
_BEHIND_SURFACE, _BEHIND_RIM = 0.4, 0.05
_LONGEST_STRETCH = 64  # of surface between two hits [cells]


@njit(cache=True, nogil=True)
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
    lower(log_odds, offsets, columns, model.miss, model.low)
    follow_beams(log_odds, x, y, beams, outline, dense, cell, model)
    if reach.max() > dense:
        far_xs, far_ys = corners(outline, np.inf, cos, sin, x, y, cell)
        # One polygon inside the other, joined by an edge there and back: what lies between them is inside.
        ring_xs = np.concatenate((far_xs, far_xs[:1], xs, xs[:1]))
        ring_ys = np.concatenate((far_ys, far_ys[:1], ys, ys[:1]))
        offsets, columns = polygon_spans(ring_xs, ring_ys, rows, cols)
        occupied = lower_unopposed(log_odds, offsets, columns, model.gap, model.gap_low)
        lower_crossed(log_odds, occupied, x, y, beams, step, dense, cell, model)

    flat = log_odds.reshape(-1)
    for i in range(len(surface)):
        seen_free = before_surface[i] < 0
        flat[surface[i]] = before_surface[i] if seen_free else max(before_surface[i], np.float32(model.surface))
    for i in range(len(hits)):
        flat[hits[i]] = min(before_hits[i] + model.hit, model.high)


@njit(cache=True, nogil=True)
def _surface_points(x: float, y: float, beams: Beams, outline: NDArray[np.float64], cell: float) -> NDArray[np.float64]:
    """Return (n, 2) x and y of points just behind where the beams ended [cells]."""
    cos, sin, reach, _kinds = beams
    points = np.empty((len(reach), 2))
    for i in range(len(reach)):
        goes_on = reach[i] > 0 and outline[i, 0] == reach[i] and outline[i - 1, 1] == reach[i]
        distance = reach[i] / cell + (_BEHIND_SURFACE if goes_on else _BEHIND_RIM)
        points[i, 0], points[i, 1] = x + distance * cos[i], y + distance * sin[i]
    return points


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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
