"""Lost links, noise and silence: what the state says, what goes out, and how it goes on."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest
from pioneer_robot import NUMBER, PATIENCE, ScriptedRobot, opened, wait_for

from drivers.pioneer import PioneerBase
from drivers.pioneer.codec import CommandNumber, Encoders
from zavis_bt.errors import DeviceError
from zavis_bt.types import Pose2D, Twist2D

START = Pose2D(2.0, 1.0)


def driving(robot: ScriptedRobot, base: PioneerBase) -> None:
    base.command(Twist2D(0.3, 0.0))
    assert wait_for(lambda: robot.velocities())


def test_a_cut_link_is_a_fault_and_nothing_moves_until_a_new_command_after_it() -> None:
    with ScriptedRobot() as robot, opened(robot, command_timeout=5.0) as base:
        driving(robot, base)
        robot.cut()
        assert wait_for(lambda: "reconnecting" in base.state().fault)
        stamp, count = base.state().stamp, len(robot.velocities())
        with pytest.raises(DeviceError, match="reconnecting"):
            command_until_refused(base)
        assert base.state().stamp == stamp
        assert wait_for(lambda: base.state().fault == "")
        assert base.state().stamp > stamp
        time.sleep(0.15)
        assert len(robot.velocities()) == count
        base.command(Twist2D(0.2, 0.0))
        assert wait_for(lambda: len(robot.velocities()) > count)
        assert base.report().figures["reconnects"] == "1"


def command_until_refused(base: PioneerBase) -> None:
    """The link is let go of a moment after the fault is told; a command in between is not sent."""
    for _ in range(1000):
        base.command(Twist2D(0.3, 0.0))
        time.sleep(0.001)


def test_odometry_goes_on_after_a_reconnection_whose_counters_begin_at_zero() -> None:
    with ScriptedRobot() as robot, opened(robot, START) as base:
        robot.sip = robot.sip._replace(x=150)
        assert wait_for(lambda: base.state().pose.x > 2.1)
        robot.cut()
        robot.sip = robot.sip._replace(x=0)
        assert wait_for(lambda: robot.connections == 2 and base.state().fault == "")
        assert base.state().pose.x == pytest.approx(2.15)
        robot.sip = robot.sip._replace(x=100)
        assert wait_for(lambda: base.state().pose.x == pytest.approx(2.25))


def test_what_the_base_did_while_the_link_was_lost_is_in_the_pose_once_the_fault_is_gone() -> None:
    with ScriptedRobot() as robot:
        robot.encoders = Encoders(1000, 1000)
        with opened(robot, START) as base:
            robot.sip = robot.sip._replace(x=150)
            assert wait_for(lambda: base.state().pose.x == pytest.approx(2.15))
            robot.cut()
            robot.sip, robot.encoders = robot.sip._replace(x=0), Encoders(1000 + 13800, 1000 + 13800)
            assert wait_for(lambda: robot.connections == 2 and base.state().fault == "")
            assert base.state().pose.x == pytest.approx(2.25)


def test_silence_is_a_fault_and_the_base_is_told_to_stop() -> None:
    with ScriptedRobot() as robot, opened(robot, command_timeout=5.0) as base:
        driving(robot, base)
        robot.sends = False
        begin = time.monotonic()
        assert wait_for(lambda: "silent for 0.5 s" in base.state().fault)
        assert time.monotonic() - begin > 0.4
        assert wait_for(lambda: NUMBER.E_STOP in robot.numbers())
        stopped = robot.numbers().index(NUMBER.E_STOP)
        robot.sends = True
        assert wait_for(lambda: base.state().fault == "")
        resumed = [command for _, command in robot.heard[stopped:] if command.number in (NUMBER.VEL, NUMBER.RVEL)]
        assert all(command.integer() == 0 for command in resumed)


def test_a_robot_that_stays_away_is_tried_again_until_it_is_back() -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        robot.refuses = True
        robot.cut()
        assert wait_for(lambda: robot.connections >= 3)
        assert base.state().fault
        robot.refuses = False
        assert wait_for(lambda: base.state().fault == "")


def test_noise_and_corrupted_packets_cost_neither_link_nor_pose() -> None:
    with ScriptedRobot() as robot, opened(robot) as base:
        for i in range(20):
            robot.sip = robot.sip._replace(x=10 * i)
            robot.add_noise(b"\x00\xfa\xfa\xfb\xc0WMS2\r" if i % 2 else b"\xfa\xfb\x05\x32\x00\x00\x00\x00")
            time.sleep(0.02)
        assert wait_for(lambda: base.state().pose.x == pytest.approx(0.19))
        assert robot.connections == 1
        assert base.state().fault == ""
        assert int(base.report().figures["checksum errors"]) > 0


def test_closing_while_the_link_is_lost_does_not_hang() -> None:
    with ScriptedRobot() as robot:
        with opened(robot) as base:
            robot.refuses = True
            robot.cut()
            assert wait_for(lambda: base.state().fault)
            begin = time.monotonic()
        assert time.monotonic() - begin < PATIENCE / 2


@pytest.mark.parametrize("ending", ["", "raise RuntimeError('a bug')"])
def test_a_program_that_ends_without_closing_still_says_farewell(ending: str) -> None:
    program = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from pioneer_robot import context
from drivers.pioneer import open_base
from zavis_bt.types import Twist2D
base = open_base({{"port": sys.argv[1]}}, context())
base.command(Twist2D(0.3, 0.0))
{ending}
"""
    with ScriptedRobot() as robot:
        subprocess.run([sys.executable, "-c", program, robot.url], capture_output=True, check=False, timeout=60)
        assert wait_for(lambda: robot.numbers()[-1:] == [CommandNumber.CLOSE])
        assert robot.numbers()[-2] == NUMBER.ENABLE
