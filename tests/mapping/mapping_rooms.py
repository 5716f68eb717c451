"""A room of cells for the tests of this folder, and scans of it."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.raycast import RayCaster
from zavis_bt.types import GridMap, LaserScan, Pose2D

CELL, ORIGIN = 0.05, (-1.0, -2.0)
LEGS = ((100, 100), (100, 130), (115, 100), (115, 130), (30, 40), (80, 170), (140, 20))


def room() -> NDArray[np.bool_]:
    """Return 8 m × 10 m with an inner wall and its door, a cupboard, and table legs of one cell."""
    walls = np.ones((160, 200), dtype=np.bool_)
    walls[2:-2, 2:-2] = False
    walls[60:62, 2:120] = True
    walls[60:62, 70:86] = False
    walls[2:20, 100:140] = True
    for leg in LEGS:
        walls[leg] = True
    return walls


def places(walls: NDArray[np.bool_], count: int, seed: int = 0) -> list[Pose2D]:
    """Return poses at least 0.2 m from anything."""
    rng = np.random.default_rng(seed)
    free = np.argwhere(cv2.distanceTransform((~walls).astype(np.uint8), cv2.DIST_L2, 5) > 4)
    chosen = free[rng.integers(len(free), size=count)] + rng.random((count, 2))
    yaws = rng.uniform(-math.pi, math.pi, count)
    return [
        Pose2D(ORIGIN[0] + CELL * col, ORIGIN[1] + CELL * row, yaw)
        for (row, col), yaw in zip(chosen.tolist(), yaws.tolist(), strict=True)
    ]


def scan_at(
    caster: RayCaster, pose: Pose2D, beams: int = 181, fov: float = math.pi, range_max: float = 30.0, stamp: float = 0.0
) -> LaserScan:
    """Return an exact scan from a pose."""
    step = fov / (beams - 1)
    angles = pose.yaw - fov / 2 + step * np.arange(beams)
    return LaserScan(caster.cast(pose.x, pose.y, angles, range_max), -fov / 2, step, 0.02, range_max, stamp)


def states_like(grid: GridMap, walls: NDArray[np.bool_]) -> NDArray[np.int8]:
    """Return the map's states at the cells of the room."""
    rows, cols = np.indices(walls.shape)
    centres = np.column_stack((cols.ravel() + 0.5, rows.ravel() + 0.5)) * CELL + ORIGIN
    cells = grid.to_cells(centres)
    inside = ((cells >= 0) & (cells < grid.shape)).all(axis=1)
    states = np.full(walls.size, -1, dtype=np.int8)
    states[inside] = grid.states[cells[inside, 0], cells[inside, 1]]
    return states.reshape(walls.shape)


def grown(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the mask with the cells around it."""
    return cv2.dilate(mask.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(np.bool_)
