"""The 16 steps of a search on a grid: 4 straight, 4 diagonal, 8 knight's moves."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import FloatArray

BORDER = 2
"""Width of an impassable rim around the grid that spares the bounds checks: that of the longest step [cells]."""


class Steps(NamedTuple):
    """Steps on a flat grid with a rim of `BORDER` cells, counter-clockwise from the x axis."""

    moves: NDArray[np.int64]
    """(16,) flat offsets."""
    lengths: FloatArray
    """(16,) [cells]"""
    angles: FloatArray
    """(16,) directions [rad]"""
    first: NDArray[np.int64]
    """(16,) flat offset of the first cell that a diagonal step or a knight's move passes; 0 for straight steps."""
    second: NDArray[np.int64]
    """(16,) that of the second."""


def steps_of(width: int) -> Steps:
    """Return the steps on a flat grid.

    Args:
        width: Cells in a row with the rim.
    """
    reach = range(-2, 3)
    pairs = [(row, col) for row in reach for col in reach if abs(row) + abs(col) == 3 or max(abs(row), abs(col)) == 1]
    pairs.sort(key=lambda pair: math.atan2(*pair) % math.tau)
    passed = np.array([_passed(row, col, width) for row, col in pairs])
    return Steps(
        np.array([row * width + col for row, col in pairs]),
        np.array([math.hypot(row, col) for row, col in pairs]),
        np.array([math.atan2(row, col) for row, col in pairs]),
        passed[:, 0].copy(),
        passed[:, 1].copy(),
    )


def _passed(row: int, col: int, width: int) -> tuple[int, int]:
    """Return the flat offsets of the cells that a step passes."""
    down, right = (row > 0) - (row < 0), (col > 0) - (col < 0)
    if row == 0 or col == 0:
        return 0, 0
    if abs(row) == abs(col):
        return down * width, right
    return (down * width if abs(row) == 2 else right), down * width + right


def open_steps(passable: NDArray[np.bool_]) -> NDArray[np.uint16]:
    """Return which steps lead from a cell to a passable one, over passable ones if it is a knight's move.

    Args:
        passable: (rows, cols).

    Returns:
        Flat grid with its rim: bit i stands for step i of `steps_of`; 0 for impassable cells.
    """
    width = passable.shape[1] + 2 * BORDER
    grid = np.pad(passable, BORDER).ravel()
    steps = steps_of(width)
    begin = BORDER * width
    inner = slice(begin, len(grid) - begin)
    found = np.zeros(len(grid), dtype=np.uint16)
    bits = found[inner]
    for i in range(16):
        knight = steps.lengths[i] > 2.0
        free = grid[inner] & _shifted(grid, inner, steps.moves[i])
        if knight:
            free &= _shifted(grid, inner, steps.first[i]) & _shifted(grid, inner, steps.second[i])
        bits |= free.astype(np.uint16) << np.uint16(i)
    return found


def _shifted(grid: NDArray[np.bool_], inner: slice, offset: np.int64) -> NDArray[np.bool_]:
    """Return the values at an offset from the inner cells; what wraps around falls on the rim and is not passable."""
    begin, end = inner.start + int(offset), inner.stop + int(offset)
    if begin >= 0 and end <= len(grid):
        return grid[begin:end]
    return np.roll(grid, -int(offset))[inner]
