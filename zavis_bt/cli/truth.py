"""A simulated robot as it really is, for a viewer."""

from __future__ import annotations

import math

import numpy as np

from sim.devices.serve import SimulatedDevices
from sim.world import World
from zavis_bt.types import (
    BaseState,
    Candidate,
    FloatArray,
    GridMap,
    Landmark,
    LaserScan,
    NodeState,
    PanTiltState,
    Path,
    Pose2D,
    RobotSpec,
    Twist2D,
    Viewpoint,
)

_STEP = 0.05  # distance between points of the trajectory [m]


class Truth:
    """What is really so: true pose, real map. Offers itself to viewers as `zavis_bt.types.Observed`.

    There is no mission, so there are no landmarks, viewpoints, candidates or trees.
    """

    landmarks: tuple[Landmark, ...] = ()
    nodes: tuple[NodeState, ...] = ()
    path: Path | None = None
    viewpoints: tuple[Viewpoint, ...] = ()
    visited: tuple[Viewpoint, ...] = ()
    candidates: tuple[Candidate, ...] = ()
    found: Candidate | None = None

    def __init__(self, devices: SimulatedDevices, world: World) -> None:
        self._devices, self.grid = devices, world.grid
        self._driven: list[tuple[float, float]] = []
        self.update()

    grid: GridMap

    def update(self) -> None:
        """Look at the robot anew."""
        plant = self._devices.plant
        motion, lidar = plant.motion, plant.spec.lidar
        pose = Pose2D(*motion.true)
        self.stamp = plant.now
        self.base = BaseState(pose, Twist2D(motion.linear, motion.angular), self.stamp, battery=plant.charge)
        self.pan_tilt = PanTiltState(*plant.joints(self.stamp), settled=True, stamp=self.stamp)
        ranges = plant.sweep(lidar.beams, lidar.angle_min, lidar.angle_increment)
        self.scan: LaserScan | None = LaserScan(
            ranges, lidar.angle_min, lidar.angle_increment, lidar.range_min, lidar.range_max, self.stamp
        )
        if not self._driven or math.dist(self._driven[-1], (pose.x, pose.y)) > _STEP:
            self._driven.append((pose.x, pose.y))

    @property
    def robot(self) -> RobotSpec:
        """The robot's model."""
        return self._devices.plant.spec

    @property
    def trajectory(self) -> FloatArray:
        """(n, 2) positions driven so far [m]."""
        return np.array(self._driven, dtype=np.float64).reshape(-1, 2)
