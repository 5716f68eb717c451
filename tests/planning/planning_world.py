"""Grids, robots and a kinematic base for the tests of planning."""

from __future__ import annotations

import math

import numpy as np

from zavis_bt.planning import Costmap, FollowStatus, Navigator, PathFollower, Progress
from zavis_bt.types import (
    FREE,
    OCCUPIED,
    BaseLimits,
    BaseState,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    GridMap,
    LaserScan,
    LidarSpec,
    PanTiltSpec,
    Path,
    Pose2D,
    RobotSpec,
    Twist2D,
)

RESOLUTION = 0.05
DISC = Footprint(0.36, 0.36, disc=True)
RECTANGLE = Footprint(0.508, 0.497)


def robot(footprint: Footprint) -> RobotSpec:
    limits = BaseLimits(0.6, 0.3, 1.8, 1.0, 4.2) if footprint.disc else BaseLimits(0.7, 0.4, 2.4, 0.3, 1.75)
    return RobotSpec(
        "test",
        footprint,
        limits,
        LidarSpec(181, math.pi, 0.05, 10.0, 10.0, Pose2D(0.0, 0.0), 0.3),
        PanTiltSpec(-3.0, 3.0, -1.0, 1.0, 2.0, 8.0),
        CameraSpec(CameraIntrinsics.from_fov(640, 480, 1.0), 0.0, 1.0, 0.3, 10.0, 10.0),
    )


def grid_of(states: np.ndarray, version: int = 0) -> GridMap:
    states = np.ascontiguousarray(states, dtype=np.int8)
    states.setflags(write=False)
    return GridMap(states, RESOLUTION, (0.0, 0.0), version)


def room(rows: int, cols: int) -> np.ndarray:
    """States of an empty room with a wall around it."""
    states = np.full((rows, cols), FREE, dtype=np.int8)
    states[[0, -1]] = OCCUPIED
    states[:, [0, -1]] = OCCUPIED
    return states


def cluttered(seed: int, size: int = 100, pieces: int = 12) -> np.ndarray:
    """States of a room with boxes at random."""
    rng = np.random.default_rng(seed)
    states = room(size, size)
    for _ in range(pieces):
        row, col = rng.integers(4, size - 12, 2)
        height, width = rng.integers(1, 12, 2)
        states[row : row + height, col : col + width] = OCCUPIED
    return states


def doors(door_cells: int) -> np.ndarray:
    """A corridor, a wall with a door and an L-turn behind it; jambs' centres are ``door_cells`` cells apart."""
    states = room(60, 140)
    states[40:, 70:] = OCCUPIED
    states[:20, 100:] = OCCUPIED
    states[:, 70] = OCCUPIED
    first = 30 - door_cells // 2
    states[first + 1 : first + door_cells, 70] = FREE
    states[20:40, 120:] = FREE
    return states


def random_places(costmap: Costmap, count: int, seed: int) -> list[Pose2D]:
    cells = np.argwhere(costmap.passable)
    chosen = cells[np.random.default_rng(seed).integers(len(cells), size=count)]
    return [Pose2D(float(x), float(y)) for x, y in costmap.grid.to_points(chosen)]


class Base:
    """A base that follows commands within its accelerations and stands still rather than enter an obstacle."""

    def __init__(self, spec: RobotSpec, truth: Costmap, pose: Pose2D) -> None:
        self.spec, self.truth = spec, truth
        self.state = BaseState(pose, Twist2D(), 0.0)
        self.contacts = 0
        self.trajectory = [pose]

    def run(self, twist: Twist2D, seconds: float = 0.1, steps: int = 5) -> None:
        for _ in range(steps):
            self._step(twist, seconds / steps)

    def _step(self, wanted: Twist2D, h: float) -> None:
        limits, now, pose = self.spec.limits, self.state.twist, self.state.pose
        change, turn_change = limits.linear_acceleration * h, limits.angular_acceleration * h
        linear = now.linear + min(max(wanted.linear - now.linear, -change), change)
        angular = now.angular + min(max(wanted.angular - now.angular, -turn_change), turn_change)
        half = angular * h / 2
        moved = pose @ Pose2D(linear * h * math.cos(half), linear * h * math.sin(half), angular * h)
        if self.truth.pose_fits(pose) and not self.truth.pose_fits(moved):
            self.contacts += 1
            moved, linear, angular = pose, 0.0, 0.0
        self.state = BaseState(moved, Twist2D(linear, angular), self.state.stamp + h)
        self.trajectory.append(moved)


def drive(base: Base, follower: PathFollower, seconds: float = 90.0, scan: LaserScan | None = None) -> list[Progress]:
    """Follow until it ends or time is up; return all that the follower said."""
    said = []
    while base.state.stamp < seconds:
        said.append(follower.update(base.state, scan))
        if said[-1].status not in (FollowStatus.DRIVING, FollowStatus.TURNING):
            break
        base.run(said[-1].twist)
    return said


def navigate(
    footprint: Footprint, states: np.ndarray, start: Pose2D, goal: Pose2D, **options: float
) -> tuple[Base, list[Progress], Path]:
    spec, grid = robot(footprint), grid_of(states)
    navigator = Navigator(spec, lambda: grid)
    base = Base(spec, Costmap(grid, footprint), start)
    path = navigator.plan(start, goal)
    return base, drive(base, navigator.follow(path, goal, **options)), path
