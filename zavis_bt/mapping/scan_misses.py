"""Misses: the cells that a scan saw through."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.mapping.sensor_model import SensorModel
from zavis_bt.mapping.visible_area import HIT, Beams

LogOddsArray = NDArray[np.float32]


@njit(cache=True, nogil=True)
def lower(
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


@njit(cache=True, nogil=True)
def lower_unopposed(
    log_odds: LogOddsArray, offsets: NDArray[np.int64], columns: NDArray[np.int64], gap: float, low: float
) -> NDArray[np.int64]:
    """Lower the cells of the spans that nothing speaks against, and return the flat indices of the others."""
    zero, loss, least = np.float32(0), np.float32(gap), np.float32(low)
    cols = log_odds.shape[1]
    occupied = np.empty(256, dtype=np.int64)
    k = 0
    for row in range(len(offsets) - 1):
        for pair in range(offsets[row], offsets[row + 1] - 1, 2):
            values = log_odds[row, columns[pair] : columns[pair + 1]]
            count = 0
            for i in range(len(values)):
                value = values[i]
                count += value > zero
                lowered = value + loss
                lowered = lowered if lowered > least else least
                values[i] = lowered if (value <= zero) & (value > least) else value
            if k + count > len(occupied):
                occupied = np.concatenate((occupied, np.empty(k + 2 * count, dtype=np.int64)))
            for i in range(len(values) if count else 0):
                if values[i] > zero:
                    occupied[k] = row * cols + columns[pair] + i
                    k += 1
    return occupied[:k]


@njit(cache=True, nogil=True)
def lower_crossed(
    log_odds: LogOddsArray,
    cells: NDArray[np.int64],
    x: float,
    y: float,
    beams: Beams,
    step: float,
    dense: float,
    cell: float,
    model: SensorModel,
) -> None:
    """Count a miss for those cells beyond the dense part of the scan whose middle a beam passed within half a cell.

    A beam that only cuts a corner says nothing.
    """
    cos, sin, reach, _kinds = beams
    flat, cols, n = log_odds.reshape(-1), log_odds.shape[1], len(reach)
    for index in cells:
        dx, dy = index % cols + 0.5 - x, index // cols + 0.5 - y
        ahead = math.atan2(cos[0] * dy - sin[0] * dx, cos[0] * dx + sin[0] * dy)
        beam = round((ahead if ahead * step >= 0 else ahead + math.copysign(math.tau, step)) / step)
        beam = min(beam, n - 1)
        along, aside = cos[beam] * dx + sin[beam] * dy, cos[beam] * dy - sin[beam] * dx
        if abs(aside) <= 0.5 and dense / cell < along < reach[beam] / cell - 1:
            flat[index] = max(flat[index] + model.miss, model.low)


@njit(cache=True, nogil=True)
def follow_beams(
    log_odds: LogOddsArray,
    x: float,
    y: float,
    beams: Beams,
    outline: NDArray[np.float64],
    dense: float,
    cell: float,
    model: SensorModel,
) -> None:
    """Take in the cells that single beams went through where the area beside them is in doubt.

    Only beams that hit something further away: one without return among others was more likely lost.
    Beyond the dense part of the scan no two beams share a cell, so each counts as a miss of what is there; nearer,
    where many may cross one cell, they only make it free if nothing speaks against.
    """
    cos, sin, reach, kinds = beams
    for i in range(len(reach)):
        begin, end = max(outline[i, 0], outline[i - 1, 1]) / cell, reach[i] / cell - 1.0
        middle = min(max(begin, dense / cell + 1.0), end)
        if kinds[i] == HIT and begin < end:
            _walk(log_odds, x, y, cos[i], sin[i], begin, middle, 0.0, model.gap)
            _walk(log_odds, x, y, cos[i], sin[i], middle, end, model.miss, model.gap)


@njit(cache=True, nogil=True)
def _walk(
    log_odds: LogOddsArray,
    x: float,
    y: float,
    cos: float,
    sin: float,
    begin: float,
    end: float,
    miss: float,
    gap: float,
) -> None:
    """Go along a beam: lower what is occupied, make the rest free.

    One cell for each step along the longer axis: the one whose middle the beam comes nearest to.
    """
    loss, floor, zero = np.float32(miss), np.float32(gap), np.float32(0)
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
        flat[index] = value + loss if value > zero else min(value, floor)
