"""The 16 steps of a search on a grid: 4 straight, 4 diagonal, 8 knight's moves."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.types import FloatArray

BORDER = 2
"""Width of an impassable rim around the grid that spares the bounds checks: that of the longest step [cells]."""


@njit(cache=True)
def steps_of(width: int) -> tuple[NDArray[np.int64], FloatArray, FloatArray, NDArray[np.int64], NDArray[np.int64]]:
    """Return the steps on a flat grid.

    Args:
        width: Cells in a row.

    Returns:
        For each of the 16 steps, straight ones first, then diagonal ones: the flat offset, the length [cells], the
        direction [rad], and the offsets of the two cells that a diagonal step or a knight's move passes.
    """
    moves, first, second = np.empty(16, np.int64), np.zeros(16, np.int64), np.zeros(16, np.int64)
    lengths, angles = np.empty(16), np.empty(16)
    i = 0
    for row, col in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        moves[i], lengths[i], angles[i] = row * width + col, 1.0, math.atan2(row, col)
        i += 1
    for row, col in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        moves[i], lengths[i], angles[i] = row * width + col, math.sqrt(2.0), math.atan2(row, col)
        first[i], second[i] = row * width, col
        i += 1
    for row, col in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        for down, right in ((2 * row, col), (row, 2 * col)):
            moves[i], lengths[i], angles[i] = down * width + right, math.sqrt(5.0), math.atan2(down, right)
            first[i], second[i] = (row * width if abs(down) == 2 else col), row * width + col
            i += 1
    return moves, lengths, angles, first, second
