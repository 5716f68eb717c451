"""Worlds and robots for the simulator's tests."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.world import World
from zavis_bt.types import (
    FREE,
    OCCUPIED,
    BaseLimits,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    GridMap,
    LidarSpec,
    PanTiltSpec,
    Pose2D,
    RobotSpec,
)


def grid_of(occupied: np.ndarray, resolution: float = 0.05, origin: tuple[float, float] = (0.0, 0.0)) -> GridMap:
    return GridMap(np.where(occupied, OCCUPIED, FREE).astype(np.int8), resolution, origin)


@pytest.fixture
def room() -> World:
    """5 m × 4 m of free floor, its lower left corner at (0, 0)."""
    occupied = np.pad(np.zeros((80, 100), dtype=np.bool_), 2, constant_values=True)
    return World("room", grid_of(occupied, origin=(-0.1, -0.1)), 2.5)


@pytest.fixture
def spec() -> RobotSpec:
    return RobotSpec(
        "disc",
        Footprint(0.36, 0.36, disc=True),
        BaseLimits(0.6, 0.3, 1.8, 1.0, 4.0),
        LidarSpec(181, math.pi, 0.05, 10.0, 10.0, Pose2D(0.1, 0.0), 0.3),
        PanTiltSpec(-math.pi, math.pi, -1.0, 1.0, 2.0, 8.0),
        CameraSpec(CameraIntrinsics.from_fov(64, 48, math.pi / 3), 0.0, 0.9, 0.1, 10.0, 5.0),
    )
