from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from zavis_bt.mission import MissionJournal, SafeRobot, SafetySettings
from zavis_bt.mission.safety import free_distance
from zavis_bt.types import (
    BaseLimits,
    BaseState,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    LaserScan,
    LidarSpec,
    PanTiltSpec,
    Pose2D,
    RobotSpec,
    Twist2D,
)

SPEC = RobotSpec(
    "test",
    Footprint(0.36, 0.36, disc=True),
    BaseLimits(0.6, 0.3, 1.8, 0.8, 3.0),
    LidarSpec(360, math.tau, 0.05, 10.0, 10.0, Pose2D(0, 0), 0.3),
    PanTiltSpec(-3.1, 3.1, -1, 1, 2, 8),
    CameraSpec(CameraIntrinsics.from_fov(64, 48, 1.0), 0.0, 0.9, 0.3, 5.0, 30.0),
)


class Devices:
    """A base that notes its commands and a LiDAR that sees a wall."""

    spec = SPEC

    def __init__(self, wall: float = math.inf) -> None:
        self.sent: list[Twist2D | str] = []
        self.current = BaseState(Pose2D(0, 0), Twist2D(), 0.0)
        angles = SPEC.lidar.angle_min + SPEC.lidar.angle_increment * np.arange(360)
        with np.errstate(divide="ignore"):
            ranges = np.where(np.cos(angles) > 1e-6, wall / np.maximum(np.cos(angles), 1e-6), np.inf)
        ranges = np.where(ranges < 10, ranges, np.inf)
        self.latest: LaserScan | None = LaserScan(
            ranges, SPEC.lidar.angle_min, SPEC.lidar.angle_increment, 0.05, 10.0, 0.0
        )
        self.base = self.lidar = self.pan_tilt = self.camera = self

    def state(self) -> BaseState:
        return self.current

    def command(self, twist: Twist2D) -> None:
        self.sent.append(twist)

    def stop(self) -> None:
        self.sent.append("stop")

    def scan(self) -> LaserScan | None:
        return self.latest

    def close(self) -> None: ...


class Now:
    def now(self) -> float:
        return 0.0

    def wait_until(self, stamp: float) -> None: ...


def tick(devices: Devices, twist: Twist2D | None, now: float = 0.0) -> list[Twist2D | str]:
    robot = SafeRobot(devices, SafetySettings(), MissionJournal(Now()))
    robot.base.read()
    if twist is not None:
        robot.base.command(twist)
    robot.base.flush(now)
    return devices.sent


def test_free_way_passes_the_twist_unchanged():
    assert tick(Devices(), Twist2D(0.5, 0.3)) == [Twist2D(0.5, 0.3)]


def test_speed_ahead_of_a_wall_leaves_room_to_brake():
    (sent,) = tick(Devices(wall=0.4), Twist2D(0.6, 0.0))
    assert 0 < sent.linear < 0.6
    assert 0.18 + sent.linear**2 / (2 * 0.8) <= 0.4


def test_in_front_of_a_wall_it_may_turn_and_reverse_but_not_go_on():
    assert tick(Devices(wall=0.19), Twist2D(0.5, 0.2)) == [Twist2D(0.0, 0.2)]
    assert tick(Devices(wall=0.19), Twist2D(-0.2, 0.0)) == [Twist2D(-0.2, 0.0)]


@pytest.mark.parametrize(
    "change",
    [{"estop": True}, {"battery": 0.01}],
    ids=["emergency stop", "flat battery"],
)
def test_an_unfit_base_stands_still(change):
    devices = Devices()
    devices.current = replace(devices.current, **change)
    assert tick(devices, Twist2D(0.5, 0.5)) == [Twist2D(0.0, 0.0)]


def test_without_a_recent_scan_the_base_stands_still():
    assert tick(Devices(), Twist2D(0.5, 0.0), now=2.0) == [Twist2D(0.0, 0.0)]
    silent = Devices()
    silent.latest = None
    assert tick(silent, Twist2D(0.5, 0.0)) == [Twist2D(0.0, 0.0)]


@pytest.mark.parametrize("fault", ["bumper", "stalled"])
def test_a_bump_allows_only_creeping_back(fault):
    devices = Devices()
    devices.current = replace(devices.current, **{fault: True})
    assert tick(devices, Twist2D(0.5, 0.0)) == [Twist2D(0.0, 0.0)]
    devices.sent.clear()
    (sent,) = tick(devices, Twist2D(-0.5, 0.0))
    assert -0.1 <= sent.linear < 0


def test_a_tick_without_a_request_stops_a_moving_base_once():
    devices = Devices()
    robot = SafeRobot(devices, SafetySettings(), MissionJournal(Now()))
    robot.base.read()
    robot.base.command(Twist2D(0.2, 0.0))
    robot.base.flush(0.0)
    robot.base.flush(0.1)
    robot.base.flush(0.2)
    assert devices.sent == [Twist2D(0.2, 0.0), "stop"]


def test_the_journal_tells_each_reason_once():
    devices, journal = Devices(wall=0.19), MissionJournal(Now())
    robot = SafeRobot(devices, SafetySettings(), journal)
    for _ in range(5):
        robot.base.read()
        robot.base.command(Twist2D(0.5, 0.0))
        robot.base.flush(0.0)
    assert journal.counts["safety"] == 1


@given(x=st.floats(-2, 2), y=st.floats(-2, 2), linear=st.sampled_from([-0.5, 0.5]), angular=st.floats(-0.8, 0.8))
def test_free_distance_is_where_a_stepwise_drive_first_meets_the_point(x, y, linear, angular):
    radius, step = 0.18, 0.002
    assume(math.hypot(x, y) > radius + 0.02)
    free = free_distance(np.array([[x, y]]), Twist2D(linear, angular), SPEC, tolerance=0.0)
    horizon = min(1.5, 3.0 * abs(linear) / max(abs(angular), 1e-9))  # short of a full turn
    turn_per_step = angular / abs(linear) * step
    pose, travelled = Pose2D(0, 0), 0.0
    while travelled < horizon and math.hypot(pose.x - x, pose.y - y) > radius:
        pose = pose @ Pose2D(math.copysign(step, linear), 0.0, turn_per_step)
        travelled += step
    closest_miss = math.hypot(pose.x - x, pose.y - y) > radius
    assert free >= travelled - 0.02 if closest_miss else free == pytest.approx(travelled, abs=0.03)
