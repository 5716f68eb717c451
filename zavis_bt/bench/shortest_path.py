"""The shortest path on which an object search could succeed: the l of SPL.

The definition is that of the episodes' ``shortest_path_length``: metres that a disc robot drives from the start to the
nearest pose from which an instance of the target is in view, whatever the heading. In view means within `VIEW_RANGE`
horizontally and with no wall on the straight line, whose last `GRACE` is not looked at. Furniture blocks driving but
never the view. Where a robot may stand, its centre is at least its radius from the centre of every cell that is not
free. The path is found by Dijkstra's algorithm over the cells in 32 directions and then pulled taut.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.types import FloatArray

ROBOT_RADIUS = 0.18  # [m]
VIEW_RANGE = 2.0  # [m]
GRACE = 0.12  # end of a line of sight that walls do not block: what stands on furniture at a wall stays visible [m]

BoolGrid = NDArray[np.bool_]


def shortest_path_length(
    occupied: BoolGrid,
    walls: BoolGrid,
    resolution: float,
    origin: tuple[float, float],
    start: tuple[float, float],
    targets: Sequence[tuple[float, float]],
    radius: float = ROBOT_RADIUS,
) -> float:
    """Return the length [m] of the shortest path from the start to a pose that has a target in view.

    Args:
        occupied: (rows, cols) cells that are not free, for whatever reason.
        walls: (rows, cols) those of them that no furniture box touches.
        resolution: Side of a cell [m].
        origin: Map coordinates of the outer corner of cell [0, 0] [m].
        start: Where the robot starts, map frame [m].
        targets: Positions of the target's instances, map frame [m].
        radius: The robot's radius [m].

    Returns:
        0 if the start is such a pose; inf if there is no path. Where the robot does not fit at the start, the path
        begins with a straight line to the nearest cells where it does.
    """
    begin = _to_cells(start, resolution, origin)
    seen = [_to_cells(target, resolution, origin) for target in targets]
    reach, grace = VIEW_RANGE / resolution, GRACE / resolution
    if any(_in_view(walls, *begin, *target, reach, grace) for target in seen):
        return 0.0
    passable = _passable(occupied, radius / resolution)
    goals = np.zeros_like(passable)
    for target in seen:
        _mark_views(goals, passable, walls, *target, reach, grace)
    points = _dijkstra(passable, goals, _first_cells(passable, *begin), *begin)
    return float(_taut_length(passable, points)) * resolution if len(points) else math.inf


def _to_cells(point: tuple[float, float], resolution: float, origin: tuple[float, float]) -> tuple[float, float]:
    """Return x and y in cells; cell [row, col] spans [col, col + 1] x [row, row + 1]."""
    return (point[0] - origin[0]) / resolution, (point[1] - origin[1]) / resolution


@njit(cache=True, nogil=True)
def _passable(occupied: BoolGrid, radius: float) -> BoolGrid:
    """Return the cells whose centre is at least ``radius`` [cells] from every occupied centre and from the outside."""
    rows, cols = occupied.shape
    passable = np.zeros((rows, cols), dtype=np.bool_)
    reach = math.ceil(radius)
    margin = max(reach - 1, 0)  # the cells beyond the edge of the map are not free either
    passable[margin : rows - margin, margin : cols - margin] = True
    limit = radius * radius - 1e-9
    for row in range(rows):
        for col in range(cols):
            if not occupied[row, col]:
                continue
            for r in range(max(row - reach, 0), min(row + reach + 1, rows)):
                for c in range(max(col - reach, 0), min(col + reach + 1, cols)):
                    if (r - row) ** 2 + (c - col) ** 2 < limit:
                        passable[r, c] = False
    return passable


@njit(cache=True, nogil=True)
def _clear(blocked: BoolGrid, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Return whether no blocked cell lies on the segment [cells]; what is outside the grid blocks."""
    rows, cols = blocked.shape
    col, row = math.floor(x0), math.floor(y0)
    dx, dy = x1 - x0, y1 - y0
    step_x, step_y = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    # Share of the segment at which the next column and row begin, and what a whole cell takes.
    next_x = (col + (dx > 0) - x0) / dx if dx != 0 else math.inf
    next_y = (row + (dy > 0) - y0) / dy if dy != 0 else math.inf
    span_x = abs(1 / dx) if dx != 0 else math.inf
    span_y = abs(1 / dy) if dy != 0 else math.inf
    while True:
        if not (0 <= row < rows and 0 <= col < cols) or blocked[row, col]:
            return False
        if min(next_x, next_y) >= 1.0 - 1e-9:
            return True
        if abs(next_x - next_y) < 1e-9:  # through a corner: the two cells beside it are only touched
            col, row = col + step_x, row + step_y
            next_x, next_y = next_x + span_x, next_y + span_y
        elif next_x < next_y:
            col, next_x = col + step_x, next_x + span_x
        else:
            row, next_y = row + step_y, next_y + span_y


@njit(cache=True, nogil=True)
def _in_view(walls: BoolGrid, x: float, y: float, tx: float, ty: float, reach: float, grace: float) -> bool:
    """Return whether the target (tx, ty) is in view from (x, y), all in cells."""
    distance = math.hypot(tx - x, ty - y)
    if distance > reach + 1e-9:
        return False
    if distance <= grace:
        return True
    share = 1 - grace / distance
    return bool(_clear(walls, x, y, x + (tx - x) * share, y + (ty - y) * share))


@njit(cache=True, nogil=True)
def _mark_views(
    goals: BoolGrid, passable: BoolGrid, walls: BoolGrid, tx: float, ty: float, reach: float, grace: float
) -> None:
    """Set the passable cells from whose centre the target is in view."""
    rows, cols = passable.shape
    for row in range(max(int(ty - reach) - 1, 0), min(int(ty + reach) + 2, rows)):
        for col in range(max(int(tx - reach) - 1, 0), min(int(tx + reach) + 2, cols)):
            if passable[row, col] and _in_view(walls, col + 0.5, row + 0.5, tx, ty, reach, grace):
                goals[row, col] = True


def _first_cells(passable: BoolGrid, x: float, y: float) -> NDArray[np.intp]:
    """Return the passable cells [row, col] whose square the start touches, or else the nearest ones, (n, 2)."""
    cells: NDArray[np.intp] = np.argwhere(passable)
    offset = np.abs(cells + 0.5 - (y, x))
    touched: NDArray[np.intp] = cells[offset.max(axis=1) <= 0.5 + 1e-6]
    if len(touched) or not len(cells):
        return touched
    distance = np.hypot(offset[:, 0], offset[:, 1])
    nearest: NDArray[np.intp] = cells[distance <= distance.min() + 1e-6]
    return nearest


@njit(cache=True, nogil=True)
def _dijkstra(passable: BoolGrid, goals: BoolGrid, first: NDArray[np.intp], x: float, y: float) -> FloatArray:
    """Return the points (x, y) [cells] from the start to the nearest goal, (n, 2); none if there is no path."""
    rows, cols = passable.shape
    blocked = ~passable
    cost = np.full((rows, cols), np.inf)
    parent = np.full((rows, cols), -1, dtype=np.int64)
    queue = [(np.inf, -1, -1)]  # a last entry that tells numba the type
    for row, col in first:
        cost[row, col] = math.hypot(col + 0.5 - x, row + 0.5 - y)
        heapq.heappush(queue, (cost[row, col], row, col))
    while len(queue) > 1:
        done, row, col = heapq.heappop(queue)
        if done > cost[row, col]:
            continue
        if goals[row, col]:
            return _trace(parent, row, col, x, y)
        for dr in range(-3, 4):
            for dc in range(-3, 4):
                r, c = row + dr, col + dc
                if not (0 <= r < rows and 0 <= c < cols) or not passable[r, c]:
                    continue
                reached = done + math.hypot(dr, dc)
                if reached < cost[r, c] and _clear(blocked, col + 0.5, row + 0.5, c + 0.5, r + 0.5):
                    cost[r, c] = reached
                    parent[r, c] = row * cols + col
                    heapq.heappush(queue, (reached, r, c))
    return np.empty((0, 2))


@njit(cache=True, nogil=True)
def _trace(parent: NDArray[np.int64], row: int, col: int, x: float, y: float) -> FloatArray:
    """Return the points [cells] from the start (x, y) to the centre of cell [row, col], (n, 2)."""
    cols = parent.shape[1]
    points = [(col + 0.5, row + 0.5)]
    while parent[row, col] >= 0:
        row, col = parent[row, col] // cols, parent[row, col] % cols
        points.append((col + 0.5, row + 0.5))
    points.append((x, y))
    path = np.empty((len(points), 2))
    for i in range(len(points)):
        path[i, 0], path[i, 1] = points[len(points) - 1 - i]
    return path


@njit(cache=True, nogil=True)
def _taut_length(passable: BoolGrid, points: FloatArray) -> float:
    """Return the length of the path [cells] after every stretch that can be driven straight has been."""
    blocked = ~passable
    total, i = 0.0, 0
    while i < len(points) - 1:
        j = len(points) - 1
        while j > i + 1 and not _clear(blocked, points[i, 0], points[i, 1], points[j, 0], points[j, 1]):
            j -= 1
        total += math.hypot(points[j, 0] - points[i, 0], points[j, 1] - points[i, 1])
        i = j
    return total
