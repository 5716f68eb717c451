"""What a robot can reach in a world, and what looks wrong about it without being an error."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sim.world import Furniture, World, mark_touched
from zavis_bt.types import FREE

_FAR = 1.0  # [m] furniture that no reachable place is this close to cannot be looked at


def passable(world: World, radius: float) -> NDArray[np.bool_]:
    """Return (rows, cols) cells in whose centre a disc of that radius [m] fits, by the costmap convention."""
    import cv2

    closed = np.pad(~world.occupied, 1).astype(np.uint8)  # what is outside the map is not free
    distance = cv2.distanceTransform(closed, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    fits: NDArray[np.bool_] = (distance > 0) & (distance * world.grid.resolution >= radius - 1e-4)
    return fits


def reachable(world: World, radius: float) -> NDArray[np.bool_]:
    """Return (rows, cols) passable cells connected with the first start, or the largest connected part."""
    import cv2

    free = passable(world, radius)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(free.astype(np.uint8), connectivity=8)
    if not free.any():
        return free
    largest = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    first = labels[_cell(world, world.starts[0].x, world.starts[0].y)] if world.starts else 0
    connected: NDArray[np.bool_] = labels == (first or largest)
    return connected


def warnings(world: World, radius: float) -> Iterable[str]:
    """Yield what a robot of that radius [m] will stumble over, one line each."""
    here = reachable(world, radius)
    for index, start in enumerate(world.starts):
        if not world.fits(start.x, start.y, radius):
            yield f"start {index + 1} at ({start.x:g}, {start.y:g}): a robot of radius {radius:g} m does not fit"
        elif not _near(world, here, start.x, start.y):
            yield f"start {index + 1} at ({start.x:g}, {start.y:g}): cut off from the first start"
    for piece in world.furniture:
        touched = np.zeros(world.grid.shape, dtype=np.bool_)
        mark_touched(touched, world.grid, piece)
        if not (touched & world.occupied).any():
            yield f"furniture '{piece.id}': the map is free where it stands (paint its cells black)"
        elif not (_grown(world, piece) & here).any():
            yield f"furniture '{piece.id}': no place within {_FAR:g} m of it can be reached"
    border = world.occupied[[0, -1]].all() and world.occupied[:, [0, -1]].all()
    if not border:
        yield "map: free cells at its edge (close it with walls: what is outside counts as not free)"


def free_area(world: World) -> float:
    """Return the free floor [m²]."""
    return float((world.grid.states == FREE).sum()) * world.grid.resolution**2


def _grown(world: World, piece: Furniture) -> NDArray[np.bool_]:
    wide = Furniture(
        piece.id, piece.category, piece.x, piece.y, piece.yaw, piece.length + 2 * _FAR, piece.width + 2 * _FAR, 1.0
    )
    cells = np.zeros(world.grid.shape, dtype=np.bool_)
    mark_touched(cells, world.grid, wide)
    return cells


def _near(world: World, cells: NDArray[np.bool_], x: float, y: float) -> bool:
    """Return whether one of the cells is the point's or next to it: the point need not be in a cell's centre."""
    row, col = _cell(world, x, y)
    return bool(cells[max(row - 1, 0) : row + 2, max(col - 1, 0) : col + 2].any())


def _cell(world: World, x: float, y: float) -> tuple[int, int]:
    (x0, y0), side = world.grid.origin, world.grid.resolution
    return math.floor((y - y0) / side), math.floor((x - x0) / side)
