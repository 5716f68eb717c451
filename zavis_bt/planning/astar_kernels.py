"""A* over a costmap's cells in 16 directions, and pulling its way taut. Lengths are in cells, as in `grid_kernels`."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.planning.distance_field import DistanceField
from zavis_bt.planning.grid_kernels import Body, body_fits, line_fits
from zavis_bt.planning.steps import BORDER, Steps
from zavis_bt.types import FloatArray

_SQRT2, _SQRT5 = math.sqrt(2.0), math.sqrt(5.0)
_STRAIGHT_ON = 0.5  # largest bend where the outline cannot turn: that between neighbouring directions [rad]
_GRAZE = 1.5  # factor on a diagonal step between cells of which one is not passable


@njit(cache=True, nogil=True)
def search(
    cost: NDArray[np.float32],
    tight: NDArray[np.bool_],
    field: DistanceField,
    body: Body,
    steps: Steps,
    width: int,
    source: int,
    target: int,
) -> NDArray[np.int32]:
    """Return the cheapest way from one cell to another.

    Where the outline fits but cannot turn, a step is taken only if the outline fits along it, and not after a step in
    another direction. Headings are not part of the search, so a way that needs a detour to enter a tight passage
    straight is found in most cases, not in all.

    Args:
        cost: Flat, with a rim of `steps.BORDER` cells: price of a unit of length, at least 1; inf where not passable.
        tight: Flat, with the same rim: cells where the outline fits but cannot turn.
        field: Distances to obstacles.
        body: The outline.
        steps: Those on the flat grid.
        width: Cells in a row with the rim.
        source: Flat index.
        target: Flat index.

    Returns:
        (n,) flat indices from the source to the target; empty if there is no way.
    """
    size = len(cost)
    best = np.full(size, np.inf, dtype=np.float32)
    parent = np.full(size, -1, dtype=np.int32)
    came = np.full(size, -1, dtype=np.int8)  # the step that led to a cell
    done = np.zeros(size, dtype=np.bool_)
    keys, cells, count = np.empty(1024, dtype=np.float32), np.empty(1024, dtype=np.int32), 0
    goal_row, goal_col = target // width, target % width
    best[source] = 0.0
    keys[0], cells[0], count = 0.0, source, 1
    while count > 0:
        cell, count = _pop(keys, cells, count)
        if done[cell]:
            continue
        done[cell] = True
        if cell == target:
            return _trace(parent, target)
        here, price = best[cell], cost[cell]
        for i in range(16):
            other = cell + steps.moves[i]
            if done[other] or cost[other] == np.inf:
                continue
            length, angle = steps.lengths[i], steps.angles[i]
            if tight[cell] or tight[other]:
                if tight[cell] and came[cell] >= 0 and _bend(angle - steps.angles[came[cell]]) > _STRAIGHT_ON:
                    continue
                if not _fits(field, body, width, cell, angle) or not _fits(field, body, width, other, angle):
                    continue
            if cost[cell + steps.first[i]] == np.inf or cost[cell + steps.second[i]] == np.inf:
                if length > 2.0:
                    continue
                length *= _GRAZE
            new = here + np.float32(0.5 * length) * (price + cost[other])
            if new < best[other]:
                best[other], parent[other], came[other] = new, cell, i
                if count == len(keys):
                    keys = np.concatenate((keys, np.empty_like(keys)))
                    cells = np.concatenate((cells, np.empty_like(cells)))
                key = new + _heuristic(abs(other // width - goal_row), abs(other % width - goal_col))
                count = _push(keys, cells, count, np.float32(key), other)
    return np.empty(0, dtype=np.int32)


@njit(cache=True, nogil=True)
def _bend(angle: float) -> float:
    return abs(angle - math.tau * math.floor(angle / math.tau + 0.5))


@njit(cache=True, nogil=True)
def _fits(field: DistanceField, body: Body, width: int, cell: int, angle: float) -> bool:
    return body_fits(field, body, float(cell % width - BORDER), float(cell // width - BORDER), angle)


@njit(cache=True, nogil=True)
def _heuristic(rows: int, cols: int) -> float:
    """Return the length of the shortest way in 16 directions on an empty grid."""
    long, short = max(rows, cols), min(rows, cols)
    if 2 * short <= long:
        return (long - 2 * short) + _SQRT5 * short
    return _SQRT5 * (long - short) + _SQRT2 * (2 * short - long)


@njit(cache=True, nogil=True)
def _push(keys: NDArray[np.float32], cells: NDArray[np.int32], count: int, key: np.float32, cell: int) -> int:
    """Add to the binary heap; return its new size."""
    i = count
    while i > 0:
        up = (i - 1) >> 1
        if keys[up] <= key:
            break
        keys[i], cells[i] = keys[up], cells[up]
        i = up
    keys[i], cells[i] = key, cell
    return count + 1


@njit(cache=True, nogil=True)
def _pop(keys: NDArray[np.float32], cells: NDArray[np.int32], count: int) -> tuple[int, int]:
    """Take the least from the binary heap; return its cell and the heap's new size."""
    top, count = cells[0], count - 1
    key, cell, i = keys[count], cells[count], 0
    while True:
        down = 2 * i + 1
        if down >= count:
            break
        if down + 1 < count and keys[down + 1] < keys[down]:
            down += 1
        if keys[down] >= key:
            break
        keys[i], cells[i] = keys[down], cells[down]
        i = down
    keys[i], cells[i] = key, cell
    return top, count


@njit(cache=True, nogil=True)
def _trace(parent: NDArray[np.int32], target: int) -> NDArray[np.int32]:
    count, cell = 0, target
    while cell >= 0:
        count += 1
        cell = parent[cell]
    way = np.empty(count, dtype=np.int32)
    cell = target
    for i in range(count - 1, -1, -1):
        way[i] = cell
        cell = parent[cell]
    return way


@njit(cache=True, nogil=True)
def pull_taut(
    field: DistanceField,
    barred: NDArray[np.bool_],
    cost: NDArray[np.float32],
    tight: NDArray[np.bool_],
    radius: float,
    points: FloatArray,
) -> FloatArray:
    """Replace stretches of a way by straight lines that fit and cost no more.

    Lines end where the outline can turn if there is such a point within sight.

    Args:
        field: Distances to obstacles.
        barred: (rows, cols) cells where the robot's middle may not be.
        cost: (rows, cols) price of a unit of length.
        tight: (rows, cols) cells where the outline fits but cannot turn.
        radius: Clearance that lines must have.
        points: (n, 2) the way (u, v).

    Returns:
        (m, 2) some of the points, the first and the last among them.
    """
    price = np.zeros(len(points))
    for i in range(1, len(points)):
        u0, v0, u1, v1 = points[i - 1, 0], points[i - 1, 1], points[i, 0], points[i, 1]
        price[i] = price[i - 1] + _line_price(cost, u0, v0, u1, v1)
    kept = np.empty(len(points), dtype=np.int64)
    kept[0], count, here = 0, 1, 0
    while here < len(points) - 1:
        there = here + 1
        for far in range(len(points) - 1, here + 1, -1):
            u0, v0, u1, v1 = points[here, 0], points[here, 1], points[far, 0], points[far, 1]
            allowed = price[far] - price[here] + 1e-6
            if line_fits(field, barred, radius, u0, v0, u1, v1) and _line_price(cost, u0, v0, u1, v1) <= allowed:
                if there == here + 1:
                    there = far
                if far == len(points) - 1 or not _at(tight, points[far, 0], points[far, 1]):
                    there = far
                    break
        kept[count] = here = there
        count += 1
    return points[kept[:count]]


@njit(cache=True, nogil=True)
def _at(mask: NDArray[np.bool_], u: float, v: float) -> bool:
    rows, cols = mask.shape
    found: bool = mask[min(max(round(v), 0), rows - 1), min(max(round(u), 0), cols - 1)]
    return found


@njit(cache=True, nogil=True)
def _line_price(cost: NDArray[np.float32], u0: float, v0: float, u1: float, v1: float) -> float:
    """Return the price of a straight line, sampled twice a cell; impassable cells that it grazes cost as their rim."""
    length = math.hypot(u1 - u0, v1 - v0)
    count = max(int(2.0 * length), 1)
    rows, cols = cost.shape
    total = 0.0
    last = 4.0
    for i in range(count):
        share = (i + 0.5) / count
        row, col = round(v0 + share * (v1 - v0)), round(u0 + share * (u1 - u0))
        if 0 <= row < rows and 0 <= col < cols and cost[row, col] < np.inf:
            last = cost[row, col]
        total += last
    return total * length / count
