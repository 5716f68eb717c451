"""Frontiers: where the free space that was seen ends without anything being seen to end it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.types import FREE, UNKNOWN, FloatArray, GridMap

MIN_LENGTH = 0.3
"""Clusters shorter than this are seams of the map rather than ways into the unknown [m]."""

_FREE, _UNKNOWN = np.int8(FREE), np.int8(UNKNOWN)


@dataclass(frozen=True, slots=True)
class Frontier:
    """An 8-connected cluster of free cells that share an edge with an unknown cell."""

    cells: NDArray[np.intp]
    """(n, 2) ``[row, col]`` in the grid it was found in."""
    centroid: tuple[float, float]
    """Mean of the cells' centres, map frame [m]; not necessarily in the cluster."""
    length: float
    """Longer side of the cluster's bounding box [m]."""


def find_frontiers(grid: GridMap, min_length: float = MIN_LENGTH) -> list[Frontier]:
    """Find the frontiers of a map. What lies outside the grid is unknown.

    A cluster's length is the number of cells along its extent, that is along the longer side of its bounding box,
    times the resolution: unknown specks enclosed by free space are surrounded by many cells but have no extent.

    Args:
        grid: The map.
        min_length: Shorter clusters are left out [m].

    Returns:
        The frontiers, ordered by their first cell, row by row.
    """
    if not grid.states.size:
        return []
    needed = max(math.ceil(min_length / grid.resolution - 1e-6), 1)
    cells, ends, extents = _clusters(np.ascontiguousarray(grid.states), needed)
    cells.setflags(write=False)
    frontiers, begin = [], 0
    for end, extent in zip(ends.tolist(), extents.tolist(), strict=True):
        members = cells[begin:end]
        x, y = grid.to_points(members).mean(axis=0).tolist()
        frontiers.append(Frontier(members, (x, y), extent * grid.resolution))
        begin = end
    return frontiers


def frontier_goal(
    frontier: Frontier, grid: GridMap, reachable: NDArray[np.bool_] | Callable[[FloatArray], NDArray[np.bool_]]
) -> tuple[float, float] | None:
    """Choose where to drive to see past a frontier: the reachable member nearest the cluster's middle.

    Args:
        frontier: From `find_frontiers`.
        grid: The map it was found in.
        reachable: (rows, cols) whether the robot can get to a cell, or a function that says so for (n, 2) points [m].

    Returns:
        The centre of the chosen cell [m], or None if the robot can get to none of the members.
    """
    points = grid.to_points(frontier.cells)
    allowed = reachable(points) if callable(reachable) else reachable[frontier.cells[:, 0], frontier.cells[:, 1]]
    if not np.any(allowed):
        return None
    squares = ((points - frontier.centroid) ** 2).sum(axis=1)
    x, y = points[np.where(allowed, squares, np.inf).argmin()].tolist()
    return x, y


@njit(cache=True, nogil=True)
def _mark(states: NDArray[np.int8]) -> NDArray[np.uint8]:
    """Return (rows + 2, cols + 2) with 1 at frontier cells; the rim lets neighbours be read without a check."""
    rows, cols = states.shape
    marks = np.zeros((rows + 2, cols + 2), dtype=np.uint8)
    nothing = np.full(cols, _UNKNOWN, dtype=np.int8)
    for row in range(rows):
        here, mark = states[row], marks[row + 1]
        below = states[row - 1] if row > 0 else nothing
        above = states[row + 1] if row + 1 < rows else nothing
        for col in range(1, cols - 1):
            beside = (here[col - 1] == _UNKNOWN) | (here[col + 1] == _UNKNOWN)
            mark[col + 1] = (here[col] == _FREE) & (beside | (below[col] == _UNKNOWN) | (above[col] == _UNKNOWN))
        mark[1] = here[0] == _FREE
        mark[cols] = here[cols - 1] == _FREE
    return marks


@njit(cache=True, nogil=True)
def _clusters(states: NDArray[np.int8], needed: int) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Return (n, 2) cells, cluster after cluster, where each cluster ends, and its extent of at least ``needed``."""
    marks = _mark(states)
    width, flat = marks.shape[1], marks.reshape(-1)
    seeds = np.flatnonzero(flat)
    found = np.empty(len(seeds), dtype=np.intp)
    cells = np.empty((len(seeds), 2), dtype=np.intp)
    ends, extents = np.empty(len(seeds), dtype=np.intp), np.empty(len(seeds), dtype=np.intp)
    count, clusters = 0, 0
    for seed in seeds:
        if not flat[seed]:
            continue
        end = _flood(flat, width, int(seed), found, count)
        for i in range(count, end):
            cells[i, 0], cells[i, 1] = found[i] // width - 1, found[i] % width - 1
        rows, cols = cells[count:end, 0], cells[count:end, 1]
        extent = max(rows.max() - rows.min(), cols.max() - cols.min()) + 1
        if extent >= needed:
            count = end
            ends[clusters], extents[clusters] = count, extent
            clusters += 1
    return cells[:count].copy(), ends[:clusters], extents[:clusters]


@njit(cache=True, nogil=True)
def _flood(flat: NDArray[np.uint8], width: int, seed: int, found: NDArray[np.intp], begin: int) -> int:
    """Move the cluster of a cell from the marks to ``found[begin:end]``, breadth first, and return the end."""
    flat[seed] = 0
    found[begin] = seed
    nearest, end = begin, begin + 1
    while nearest < end:
        middle = found[nearest]
        nearest += 1
        for row in range(-1, 2):
            for col in range(-1, 2):
                neighbour = middle + row * width + col
                if flat[neighbour]:
                    flat[neighbour] = 0
                    found[end] = neighbour
                    end += 1
    return end
