"""What every base must do."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator

import pytest
from conformance_rigs import KINDS, PERIOD, Rig, duration, open_rig
from conformance_room import BEFORE_A_WALL, MIDDLE, WIDTH

from zavis_bt.types import Pose2D, Twist2D, wrap_angle

START = MIDDLE


def ways(rig: Rig, act: Callable[[], object]) -> tuple[Pose2D, Pose2D]:
    """Return how an act moved the base until it stood again: really, and by odometry; each seen from where it began."""
    true, odometry = rig.truth(), rig.robot.base.state().pose
    act()
    rig.rest()
    return true.inverse() @ rig.truth(), odometry.inverse() @ rig.robot.base.state().pose


def steps(poses: list[Pose2D]) -> list[tuple[float, float]]:
    """Return distance and turn between neighbours."""
    pairs = itertools.pairwise(poses)
    return [(one.distance(two), abs(wrap_angle(two.yaw - one.yaw))) for one, two in pairs]


def test_it_is_well_at_first_and_stands_still(rig: Rig) -> None:
    before = rig.robot.base.state()
    rig.run(0.3)
    after = rig.robot.base.state()
    assert (after.fault, after.bumper, after.stalled, after.estop) == ("", False, False, False)
    assert 0 < after.battery <= 1
    assert after.pose.distance(before.pose) < 0.002
    assert abs(wrap_angle(after.pose.yaw - before.pose.yaw)) < 0.005


def test_odometry_begins_at_the_start(rig: Rig) -> None:
    assert rig.first.distance(rig.start) < 0.002
    assert wrap_angle(rig.first.yaw - rig.start.yaw) == pytest.approx(0, abs=0.002)


@pytest.mark.parametrize("share", [1.0, -0.5])
def test_a_commanded_speed_is_reached_within_the_acceleration_limit(rig: Rig, share: float) -> None:
    speed, limit = share * rig.cruise, rig.robot.spec.limits.linear_acceleration
    begin = rig.robot.base.state().stamp
    for state in rig.reach(Twist2D(speed, 0.0)):
        ramp = limit * (state.stamp - begin + rig.slack)
        assert abs(state.twist.linear) <= min(ramp, abs(speed)) + rig.linear_error
        assert abs(state.twist.angular) <= rig.angular_error


@pytest.mark.parametrize("share", [1.0, -1.0])
def test_a_commanded_rate_is_reached_within_the_acceleration_limit(rig: Rig, share: float) -> None:
    rate, limit = share * rig.spin, rig.robot.spec.limits.angular_acceleration
    begin = rig.robot.base.state().stamp
    for state in rig.reach(Twist2D(0.0, rate)):
        ramp = limit * (state.stamp - begin + rig.slack)
        assert abs(state.twist.angular) <= min(ramp, abs(rate)) + rig.angular_error
        assert abs(state.twist.linear) <= rig.linear_error


@pytest.mark.parametrize("twist", [Twist2D(0.4, 0.0), Twist2D(0.0, 0.8), Twist2D(-0.25, -0.6)], ids=str)
def test_odometry_agrees_with_the_way(rig: Rig, twist: Twist2D) -> None:
    true, odometry = ways(rig, lambda: rig.drive(twist, 0.6))
    length, turn = math.hypot(true.x, true.y), abs(true.yaw)
    assert length + turn > 0.05
    # Forward is along the heading, left turns are positive.
    assert math.copysign(length, twist.linear) == pytest.approx(true.x, abs=0.02)
    assert math.copysign(turn, twist.angular) == pytest.approx(true.yaw, abs=0.02)
    assert odometry.distance(true) < 0.02 * length + 0.005
    assert abs(wrap_angle(odometry.yaw - true.yaw)) < 0.02 * turn + 0.01


def test_without_further_commands_it_comes_to_rest_by_itself(rig: Rig) -> None:
    rig.reach(Twist2D(rig.cruise / 2, rig.spin / 2))
    begin = rig.clock.now()
    assert rig.wait_for(rig.stands)
    braking = rig.cruise / 2 / rig.robot.spec.limits.linear_acceleration
    assert rig.clock.now() - begin < 1.0 + braking + 1.0


def test_a_command_of_zero_brings_it_to_rest(rig: Rig) -> None:
    rig.reach(Twist2D(rig.cruise / 2, 0.0))
    rig.reach(Twist2D(0.0, 0.0))


def test_stop_is_faster_than_a_ramp(rig: Rig) -> None:
    rig.only_simulated("needs speed")
    limits = rig.robot.spec.limits
    rig.reach(Twist2D(limits.max_linear, 0.0))
    begin = rig.truth()
    rig.robot.base.stop()
    assert rig.wait_for(rig.stands)
    rig.run(0.05)
    assert rig.truth().distance(begin) < 0.75 * limits.max_linear**2 / (2 * limits.linear_acceleration)


def test_stop_may_be_called_at_any_time_and_twice(rig: Rig) -> None:
    rig.robot.base.stop()
    rig.robot.base.stop()
    rig.drive(Twist2D(rig.cruise / 2, rig.spin / 2), 0.3)
    rig.robot.base.stop()
    rig.robot.base.stop()
    assert rig.wait_for(rig.stands)
    before = rig.robot.base.state().pose
    rig.run(0.3)
    assert rig.robot.base.state().pose.distance(before) < 0.002


def test_it_drives_on_after_a_stop(rig: Rig) -> None:
    rig.drive(Twist2D(rig.cruise / 2, 0.0), 0.3)
    rig.robot.base.stop()
    rig.reach(Twist2D(rig.cruise / 2, 0.0))


def test_commands_are_clipped_to_the_limits(rig: Rig) -> None:
    rig.only_simulated("would drive at full speed")
    limits = rig.robot.spec.limits
    rig.reach(Twist2D(9.0, 99.0), Twist2D(limits.max_linear, limits.max_angular))
    rig.reach(Twist2D(-9.0, -99.0), Twist2D(-limits.max_reverse, -limits.max_angular))


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_what_is_not_a_velocity_is_refused_and_changes_nothing(rig: Rig, number: float) -> None:
    before = rig.robot.base.state().pose
    for twist in (Twist2D(number, 0.0), Twist2D(0.0, number)):
        with pytest.raises(ValueError, match="not a velocity"):
            rig.robot.base.command(twist)
    rig.run(0.2)
    assert rig.robot.base.state().pose.distance(before) < 0.002


def test_the_pose_at_a_states_stamp_is_that_states_pose(rig: Rig) -> None:
    for state in rig.drive(Twist2D(rig.cruise / 2, rig.spin), 0.6):
        pose = rig.robot.base.pose_at(state.stamp)
        assert pose.distance(state.pose) < 1e-6
        assert abs(wrap_angle(pose.yaw - state.pose.yaw)) < 1e-6


def test_poses_of_the_last_second_follow_one_another_without_jumps(rig: Rig) -> None:
    rig.drive(Twist2D(rig.cruise / 2, rig.spin / 2), 0.6)
    now, limits = rig.robot.base.state().stamp, rig.robot.spec.limits
    poses = [rig.robot.base.pose_at(now - 1 + share / 100) for share in range(101)]
    for distance, turn in steps(poses):
        # A simulation in lock step knows poses at its steps of 0.02 s, and gives the nearest one.
        assert distance < limits.max_linear * 0.021 + rig.jump
        assert turn < limits.max_angular * 0.021 + rig.jump
    assert sum(distance for distance, _ in steps(poses)) > 0.02


def test_the_pose_at_other_times_is_the_nearest_known(rig: Rig) -> None:
    rig.drive(Twist2D(rig.cruise / 2, 0.0), 0.3)
    rig.rest()
    rig.run(0.1)
    state = rig.robot.base.state()
    assert rig.robot.base.pose_at(state.stamp + 1e6).distance(state.pose) < 0.002
    assert rig.robot.base.pose_at(-1e6).distance(state.pose) < 5


def test_stamps_are_on_the_clock_and_never_go_back(rig: Rig) -> None:
    stamps = []
    for _ in range(10):
        stamp = rig.robot.base.state().stamp
        assert rig.clock.now() - rig.stale <= stamp <= rig.clock.now()
        stamps.append(stamp)
        rig.run(PERIOD / 2)
    assert stamps == sorted(stamps)
    assert stamps[-1] > stamps[0]


def test_nothing_blocks(rig: Rig) -> None:
    base = rig.robot.base
    assert duration(base.state) < 0.002
    assert duration(lambda: base.pose_at(0.0)) < 0.002
    assert duration(lambda: base.command(Twist2D(0.0, 0.0)), 20) < 0.01
    assert duration(base.stop, 20) < 0.01


@pytest.fixture(params=[kind for kind in KINDS if kind != "hardware"])
def before_a_wall(request: pytest.FixtureRequest, tmp_path) -> Iterator[Rig]:
    with open_rig(request.param, tmp_path, BEFORE_A_WALL) as rig:
        yield rig


def test_a_wall_holds_it_which_it_says_and_it_can_back_away(before_a_wall: Rig) -> None:
    rig = before_a_wall
    base = rig.robot.base

    def touched() -> bool:
        base.command(Twist2D(rig.cruise, 0.0))
        return base.state().bumper or base.state().stalled

    assert rig.wait_for(touched, PERIOD)
    rig.rest()
    assert rig.truth().x < WIDTH - rig.robot.spec.footprint.length / 2 + 0.1  # obstacles are known by their cells
    held = rig.truth()
    rig.reach(Twist2D(-0.2, 0.0))
    rig.drive(Twist2D(-0.2, 0.0), 0.3)
    rig.rest()
    assert rig.truth().x < held.x - 0.03
    assert (base.state().bumper, base.state().stalled) == (False, False)
