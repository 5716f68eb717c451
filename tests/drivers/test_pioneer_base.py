"""Driving: what goes out, when, and what the state says."""

from __future__ import annotations

import math
import time

import pytest
from pioneer_robot import NUMBER, ScriptedRobot, opened, wait_for

from drivers.pioneer.codec import Flags
from zavis_bt.errors import DeviceError
from zavis_bt.types import Pose2D, Twist2D

START = Pose2D(2.0, 1.0, math.pi / 2)


def test_a_command_goes_out_in_the_robots_units_again_and_again() -> None:
    with ScriptedRobot() as robot, opened(robot, command_timeout=5.0) as base:
        base.command(Twist2D(0.25, -0.5))
        assert wait_for(lambda: len(robot.velocities()) >= 10)
        assert {value for _, value in robot.velocities()} == {250, -29}


def test_commands_are_clipped_to_the_limits() -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        base.command(Twist2D(-9.0, 9.0))
        assert wait_for(lambda: len(robot.velocities()) >= 2)
        assert {value for _, value in robot.velocities()} == {-400, 140}


@pytest.mark.parametrize("twist", [Twist2D(math.nan, 0.0), Twist2D(0.0, math.inf)], ids=str)
def test_what_is_not_a_velocity_is_refused(twist: Twist2D) -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        with pytest.raises(ValueError, match="not a velocity"):
            base.command(twist)
        assert robot.velocities() == []


def test_a_base_that_hears_no_command_any_more_is_halted() -> None:
    with ScriptedRobot() as robot, opened(robot, command_timeout=0.2) as base:
        base.command(Twist2D(0.3, 0.0))
        assert wait_for(lambda: robot.velocities())
        assert wait_for(lambda: (robot.heard[-1][1].number, robot.heard[-1][1].integer()) == (NUMBER.PULSE, 0))
        count = len(robot.velocities())
        halts = [command for _, command in robot.heard if command.number == NUMBER.VEL and command.integer() == 0]
        assert len(halts) >= 3
        time.sleep(0.15)
        assert len(robot.velocities()) == count


def test_an_idle_base_hears_signs_of_life() -> None:
    with ScriptedRobot() as robot, opened(robot):
        assert wait_for(lambda: robot.numbers().count(NUMBER.PULSE) >= 3)


def test_stop_is_an_emergency_stop_at_once_and_nothing_follows_until_the_next_command() -> None:
    with ScriptedRobot() as robot, opened(robot, command_timeout=5.0) as base:
        base.command(Twist2D(0.3, 0.2))
        assert wait_for(lambda: len(robot.velocities()) >= 4)
        base.stop()
        assert wait_for(lambda: NUMBER.E_STOP in robot.numbers())
        heard = len(robot.velocities())
        assert wait_for(lambda: NUMBER.PULSE in robot.numbers()[robot.numbers().index(NUMBER.E_STOP) :])
        base.stop()
        assert len(robot.velocities()) == heard
        base.command(Twist2D(0.1, 0.0))
        assert wait_for(lambda: len(robot.velocities()) > heard)


def test_the_state_follows_the_robot() -> None:
    with ScriptedRobot() as robot, opened(robot, START) as base:
        assert base.state().pose == START
        robot.sip = robot.sip._replace(
            moving=True, x=100, heading=256, left_velocity=80, right_velocity=120, rotational_velocity=None
        )
        assert wait_for(lambda: base.state().pose.y > 1.0)
        state = base.state()
        assert (state.pose.x, state.pose.y) == (pytest.approx(2.0), pytest.approx(1.1))
        assert state.pose.yaw == pytest.approx(5 * math.pi / 8)
        assert state.twist.linear == pytest.approx(0.1)
        assert state.twist.angular == pytest.approx(20 * 0.0034)
        assert base.pose_at(state.stamp) == state.pose
        assert state.battery == pytest.approx(0.75)
        assert [state.bumper, state.stalled, state.estop] == [False] * 3
        robot.sip = robot.sip._replace(left_velocity=0, right_velocity=0)
        assert wait_for(lambda: base.state().twist.linear == 0)


def test_bumper_stall_battery_and_sonar_are_told() -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        robot.sip = robot.sip._replace(right_stall=0b101, battery_x10=112, sonar=((3, 1500), (4, 5000), (99, 7)))
        assert wait_for(lambda: base.state().stalled)
        assert base.state().bumper
        assert base.state().battery == pytest.approx(0.1)
        ahead, nothing = base.sonar()
        assert (ahead.number, ahead.range, nothing.range) == (3, 1.5, math.inf)
        assert ahead.mount.x == pytest.approx(0.245)
        assert any("battery" in problem for problem in base.report().problems)


def test_a_reported_state_of_charge_goes_before_the_voltage() -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        robot.sip = robot.sip._replace(charge_percent=40)
        assert wait_for(lambda: base.state().battery == pytest.approx(0.4))


def test_the_stop_button_ends_motion_and_nothing_resumes_when_it_is_released() -> None:
    with ScriptedRobot() as robot, opened(robot, command_timeout=5.0) as base:
        base.command(Twist2D(0.3, 0.0))
        assert wait_for(lambda: robot.velocities())
        robot.sip = robot.sip._replace(flags=int(Flags.STOP_PRESSED))
        assert wait_for(lambda: base.state().estop)
        assert "STOP button" in base.state().fault
        base.command(Twist2D(0.3, 0.0))
        count = len(robot.velocities())
        robot.sip = robot.sip._replace(flags=0)
        assert wait_for(lambda: not base.state().estop)
        assert "MOTORS button" in base.state().fault
        robot.sip = robot.sip._replace(flags=int(Flags.MOTORS_ENABLED))
        assert wait_for(lambda: base.state().fault == "")
        time.sleep(0.15)
        assert len(robot.velocities()) - count <= 1  # what was on its way when the button was told
        count = len(robot.velocities())
        base.command(Twist2D(0.3, 0.0))
        assert wait_for(lambda: len(robot.velocities()) > count)


def test_motors_that_somebody_switched_off_are_not_switched_on_again() -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        enabled = robot.numbers().count(NUMBER.ENABLE)
        robot.sip = robot.sip._replace(flags=0)
        assert wait_for(lambda: "somebody has switched the motors off" in base.state().fault)
        time.sleep(0.2)
        assert robot.numbers().count(NUMBER.ENABLE) == enabled
        base.command(Twist2D(0.3, 0.0))
        assert wait_for(lambda: robot.numbers().count(NUMBER.PULSE) >= 2)
        assert robot.velocities() == []


def test_closing_halts_switches_the_motors_off_and_ends_the_connection() -> None:
    with ScriptedRobot() as robot:
        with opened(robot) as base:
            base.command(Twist2D(0.3, 0.0))
            assert wait_for(lambda: robot.velocities())
        assert wait_for(lambda: robot.numbers()[-1] == NUMBER.CLOSE)
        last = [(command.number, command.argument) for _, command in robot.heard[-4:]]
        assert last == [(NUMBER.VEL, 0), (NUMBER.RVEL, 0), (NUMBER.ENABLE, 0), (NUMBER.CLOSE, 1)]
        base.close()
        base.stop()
        with pytest.raises(DeviceError):
            base.command(Twist2D(0.1, 0.0))


def test_a_moving_base_comes_to_rest_before_its_motors_are_switched_off() -> None:
    with ScriptedRobot() as robot:
        with opened(robot) as base:
            robot.sip = robot.sip._replace(left_velocity=300, right_velocity=300)
            assert wait_for(lambda: base.state().twist.linear > 0)
        assert wait_for(lambda: robot.numbers()[-1] == NUMBER.CLOSE)
        times = {command.number: at for at, command in robot.heard}  # of the last one of each
        first_stop = next(at for at, command in robot.heard if command.number == NUMBER.E_STOP)
        assert times[NUMBER.CLOSE] - first_stop > 0.5
