"""Exact distances to the nearest obstacle cell.

Two passes (A. Meijster, J. Roerdink, W. Hesselink: A general algorithm for computing distance transforms in linear
time, 2000): along the columns the nearest obstacle row, along the rows the lower envelope of parabolas. Lengths are in
cells; the centre of cell [row, col] is at (u, v) = (col, row).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

_FAR = 16_000  # coordinate of the obstacle of a grid without obstacles; larger than any grid [cells]


class DistanceField(NamedTuple):
    """For each cell, which obstacle cell is nearest, and how far."""

    distance: NDArray[np.float32]
    """(rows, cols) between cell centres [cells]; inf if there are no obstacles."""
    nearest: NDArray[np.int16]
    """(rows, cols, 2) ``[row, col]`` of the nearest obstacle; may lie just outside the grid."""
    obstacle: NDArray[np.bool_]
    """(rows, cols)"""
    closed: bool
    """Whether what lies outside the grid is an obstacle."""


def distance_field(obstacle: NDArray[np.bool_], closed: bool = False) -> DistanceField:
    """Compute the exact Euclidean distance field of a grid.

    Args:
        obstacle: (rows, cols).
        closed: Whether the cells around the grid are obstacles too.

    Returns:
        The field; owns its arrays, which are read-only, but for `obstacle`, which is the argument.
    """
    if closed:
        distance, nearest = _transform(np.pad(obstacle, 1, constant_values=True))
        distance, nearest = np.ascontiguousarray(distance[1:-1, 1:-1]), nearest[1:-1, 1:-1] - np.int16(1)
    else:
        distance, nearest = _transform(obstacle)
    distance.setflags(write=False)
    nearest.setflags(write=False)
    return DistanceField(distance, nearest, obstacle, closed)


@njit(cache=True, nogil=True)
def _transform(obstacle: NDArray[np.bool_]) -> tuple[NDArray[np.float32], NDArray[np.int16]]:
    rows, cols = obstacle.shape
    nearest_row = _nearest_rows(obstacle)
    distance = np.empty((rows, cols), dtype=np.float32)
    nearest = np.empty((rows, cols, 2), dtype=np.int16)
    apex = np.empty(cols, dtype=np.int64)  # columns of the parabolas on the envelope
    begin = np.empty(cols, dtype=np.int64)  # first column where each of them is lowest
    for row in range(rows):
        count = 0
        for col in range(cols):
            if nearest_row[row, col] == _FAR:
                continue
            height = (row - nearest_row[row, col]) ** 2
            start = 0
            while count > 0:
                last = apex[count - 1]
                drop = (row - nearest_row[row, last]) ** 2
                start = (col * col - last * last + height - drop) // (2 * (col - last)) + 1
                if start > begin[count - 1]:
                    break
                count -= 1
                start = 0
            if start < cols:
                apex[count], begin[count] = col, start
                count += 1
        index = 0
        for col in range(cols):
            if count == 0:
                distance[row, col] = math.inf
                nearest[row, col, 0] = nearest[row, col, 1] = _FAR
                continue
            while index + 1 < count and begin[index + 1] <= col:
                index += 1
            best = apex[index]
            up = nearest_row[row, best]
            distance[row, col] = math.sqrt((col - best) ** 2 + (row - up) ** 2)
            nearest[row, col, 0], nearest[row, col, 1] = up, best
    return distance, nearest


@njit(cache=True, nogil=True)
def _nearest_rows(obstacle: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Return for each cell the row of the nearest obstacle in its column; `_FAR` if there is none."""
    rows, cols = obstacle.shape
    nearest = np.full((rows, cols), _FAR, dtype=np.int32)
    for row in range(rows):
        for col in range(cols):
            if obstacle[row, col]:
                nearest[row, col] = row
            elif row > 0:
                nearest[row, col] = nearest[row - 1, col]
    for row in range(rows - 2, -1, -1):
        for col in range(cols):
            below = nearest[row + 1, col]
            if below != _FAR and abs(below - row) < abs(nearest[row, col] - row):
                nearest[row, col] = below
    return nearest
