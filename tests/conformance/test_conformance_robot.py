"""What every robot must do."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from conformance_rigs import KINDS, Rig, open_rig
from conformance_room import MIDDLE

from zavis_bt.protocols import Base, Camera, Clock, Lidar, PanTilt, Robot
from zavis_bt.types import RobotSpec, Twist2D


@pytest.fixture(params=KINDS)
def rig(request: pytest.FixtureRequest, tmp_path) -> Iterator[Rig]:
    with open_rig(request.param, tmp_path, MIDDLE) as rig:
        yield rig


def accept(robot: Robot, clock: Clock) -> tuple[RobotSpec, Base, PanTilt, Lidar, Camera]:
    """Return what a robot has."""
    assert clock.now() >= 0
    return robot.spec, robot.base, robot.pan_tilt, robot.lidar, robot.camera


def test_its_devices_deliver_soon_after_it_is_opened_and_stay_the_same(rig: Rig) -> None:
    robot = rig.robot
    before = accept(robot, rig.clock)
    assert rig.wait_for(lambda: robot.lidar.scan() is not None and robot.camera.frame() is not None)
    assert robot.base.state().fault == robot.pan_tilt.state().fault == ""
    assert all(one is two for one, two in zip(before, accept(robot, rig.clock), strict=True))


def test_closing_ends_all_motion_and_may_be_done_twice(rig: Rig) -> None:
    robot = rig.robot
    robot.pan_tilt.move_to(rig.sweep, 0.0)
    rig.drive(Twist2D(rig.cruise / 2, 0.0), 0.5)
    robot.close()
    robot.close()
    rig.run(0.6)
    before = rig.truth()
    rig.run(0.4)
    assert rig.truth().distance(before) < 0.001


def test_stops_after_closing_raise_nothing(rig: Rig) -> None:
    rig.robot.close()
    rig.robot.base.stop()
    rig.robot.pan_tilt.stop()
