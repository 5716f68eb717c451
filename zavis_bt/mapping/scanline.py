"""Polygons to rows of cells: which cells have their centre inside, each exactly once."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Spans = tuple[NDArray[np.int64], NDArray[np.int64]]
"""Offsets (rows + 1,) and columns (k,): in row r the cells of ``columns[offsets[r]:offsets[r + 1]]``, taken in
pairs ``[first, end)``, lie inside."""


@njit(cache=True, nogil=True)
def polygon_spans(xs: NDArray[np.float64], ys: NDArray[np.float64], rows: int, cols: int) -> Spans:
    """Find the cells whose centres lie inside a closed polygon (even-odd rule).

    Borders are half open, so polygons that share an edge share no cell.

    Args:
        xs: (n,) corners in columns, cell [0, 0] spans 0 to 1.
        ys: (n,) corners in rows.
        rows: Rows of the grid; what lies outside is cut off.
        cols: Columns of the grid.

    Returns:
        The spans of every row.
    """
    offsets = np.zeros(rows + 2, dtype=np.int64)
    corners = len(xs)
    for i in range(corners):
        y0, y1 = ys[i - 1], ys[i]
        first, end = _rows_between(min(y0, y1), max(y0, y1), rows)
        for row in range(first, end):
            offsets[row + 2] += 1
    for row in range(rows):
        offsets[row + 2] += offsets[row + 1]
    columns = np.empty(offsets[rows + 1], dtype=np.int64)
    for i in range(corners):
        x0, y0, x1, y1 = xs[i - 1], ys[i - 1], xs[i], ys[i]
        first, end = _rows_between(min(y0, y1), max(y0, y1), rows)
        if first < end:
            slope = (x1 - x0) / (y1 - y0)
            for row in range(first, end):
                crossing = x0 + (row + 0.5 - y0) * slope
                columns[offsets[row + 1]] = min(max(math.ceil(crossing - 0.5), 0), cols)
                offsets[row + 1] += 1
    for row in range(rows):
        _sort(columns, offsets[row], offsets[row + 1])
    return offsets[: rows + 1], columns


@njit(cache=True, inline="always")
def _rows_between(low: float, high: float, rows: int) -> tuple[int, int]:
    """Return the rows [first, end) whose centres lie in [low, high)."""
    return max(math.ceil(low - 0.5), 0), min(math.ceil(high - 0.5), rows)


@njit(cache=True, inline="always")
def _sort(values: NDArray[np.int64], first: int, end: int) -> None:
    """Sort a short stretch in place."""
    for i in range(first + 1, end):
        value = values[i]
        j = i - 1
        while j >= first and values[j] > value:
            values[j + 1] = values[j]
            j -= 1
        values[j + 1] = value
