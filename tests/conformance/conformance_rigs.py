"""Everything that plays a robot, behind one small harness, so that a claim is written once for all of them.

``lockstep``  the simulator in this process, whose clock advances the world
``wire``      the drivers against the simulated devices, over sockets and a CAN bus, in real time
``hardware``  the robot of the file that the environment variable ``ZAVIS_HARDWARE`` names; left out if it is not set

On hardware the claims that need to know where things really are, or that would drive far, are skipped. What is left
turns and drives a few decimetres, at most 0.15 m/s and 0.4 rad/s, and pans by 40 degrees: put the robot on the floor
with a metre of free space around it, keep a hand on the emergency stop, and run

    ZAVIS_HARDWARE=my.robot.yaml pytest tests/conformance -k hardware
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from conformance_room import MIDDLE, ROBOT, room

from sim import Simulation
from sim.devices.serve import SimulatedDevices
from zavis_bt.mission.clock import WallClock
from zavis_bt.mission.device_robot import DeviceRobot
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.protocols import Clock, Robot
from zavis_bt.types import BaseState, Pose2D, Twist2D

HARDWARE = os.environ.get("ZAVIS_HARDWARE", "")
KINDS = ("lockstep", "wire", *(["hardware"] if HARDWARE else []))
PERIOD = 0.1
"""Between two commands, as a mission gives them [s]."""
_PATIENT = {"base": {"silence": 3.0}, "pan_tilt": {"answer_timeout": 3.0, "heartbeat_timeout": 3.0}}
"""Settings of drivers that must not lose a device because the machine is busy."""
PATIENCE = 20.0
"""How long to wait for what must happen [s]; in lock step this costs nothing."""


@dataclass
class Rig:
    """A robot, its clock, and what is known of it from outside."""

    kind: str
    robot: Robot
    clock: Clock
    start: Pose2D
    where: Callable[[], Pose2D] | None = None
    """The base's true pose; unknown on hardware."""
    cruise: float = 0.4
    """A speed for tests [m/s]."""
    spin: float = 0.8
    """A turning rate for tests [rad/s]."""
    sweep: float = 0.6
    """An angle for tests of the pan axis [rad]."""
    stale: float = 0.03
    """Age of a state that has just been read, at most [s]."""
    jump: float = 1e-6
    """Between two poses that follow one another, beyond what the motion explains [m, rad]."""
    slack: float = 0.02
    """Error of the states' stamps [s]."""
    linear_error: float = 1e-9
    """Of a measured velocity [m/s]."""
    angular_error: float = 1e-9
    """Of a measured rate [rad/s]."""
    angle_error: float = 1e-6
    """Of a joint at its target [rad]."""
    turning_error: float = 1e-3
    """Of ranges scanned while turning: half a scan's time would be 0.075 [m]."""
    first: Pose2D = field(init=False)
    """By odometry, when the robot was opened."""

    def __post_init__(self) -> None:
        self.first = self.robot.base.state().pose

    def truth(self) -> Pose2D:
        """Return where the base really is; the test is skipped where nobody knows."""
        self.only_simulated("nobody knows where the base really is")
        assert self.where is not None
        return self.where()

    def only_simulated(self, why: str) -> None:
        """Leave a test out where it must not or cannot run: on hardware, which is there if ZAVIS_HARDWARE names it."""
        if self.where is None:
            pytest.skip(f"not on hardware: {why}")  # simulator and drivers never come here

    def run(self, seconds: float) -> None:
        """Let time pass."""
        self.clock.wait_until(self.clock.now() + seconds)

    def drive(self, twist: Twist2D, seconds: float) -> list[BaseState]:
        """Command a velocity again and again; return the states on the way."""
        states, end = [], self.clock.now() + seconds
        while self.clock.now() < end - 1e-9:
            self.robot.base.command(twist)
            self.run(min(PERIOD, end - self.clock.now()))
            states.append(self.robot.base.state())
        return states

    def reach(self, asked: Twist2D, expected: Twist2D | None = None) -> list[BaseState]:
        """Command a velocity until the base has it, or the expected one; return the states on the way."""
        states, wanted = [], expected or asked

        def reached() -> bool:
            self.robot.base.command(asked)
            states.append(self.robot.base.state())
            twist = states[-1].twist
            linear, angular = abs(twist.linear - wanted.linear), abs(twist.angular - wanted.angular)
            return linear <= self.linear_error and angular <= self.angular_error

        assert self.wait_for(reached, PERIOD / 2), states[-1]
        return states

    def wait_for(self, condition: Callable[[], bool], step: float = 0.02) -> bool:
        """Let time pass until the condition holds; return whether it came to that."""
        end = self.clock.now() + PATIENCE
        while not condition():
            if self.clock.now() > end:
                return False
            self.run(step)
        return True

    def stands(self) -> bool:
        twist = self.robot.base.state().twist
        return abs(twist.linear) < 0.005 and abs(twist.angular) < 0.01

    def settled(self) -> bool:
        return self.robot.pan_tilt.state().settled

    def rest(self) -> None:
        """Come to rest, so that a test may begin."""
        self.robot.base.stop()
        self.robot.pan_tilt.stop()
        heard = self.robot.base.state().stamp
        assert self.wait_for(lambda: self.robot.base.state().stamp > heard + 0.02 or self.kind == "lockstep")
        assert self.wait_for(self.stands)
        assert self.wait_for(self.settled)


def duration(call: Callable[[], object], times: int = 200) -> float:
    """Return the median wall time of a call [s]."""
    spent = []
    for _ in range(times):
        begin = time.perf_counter()
        call()
        spent.append(time.perf_counter() - begin)
    return sorted(spent)[times // 2]


@contextmanager
def open_rig(kind: str, folder: Path, start: Pose2D = MIDDLE) -> Iterator[Rig]:
    """Open one robot, and close it again with whatever it stands in."""
    with ExitStack() as stack:
        rig = {"lockstep": _lockstep, "wire": _wire, "hardware": _hardware}[kind](stack, folder, start)
        yield rig


def _lockstep(stack: ExitStack, folder: Path, start: Pose2D) -> Rig:
    simulation = Simulation(room(), load_robot(_robot_file(folder)).spec, start)
    stack.callback(simulation.robot.close)
    return Rig("lockstep", simulation.robot, simulation.clock, start, lambda: simulation.truth)


def _wire(stack: ExitStack, folder: Path, start: Pose2D) -> Rig:
    spec = load_robot(_robot_file(folder)).spec
    devices = stack.enter_context(SimulatedDevices(room(), spec, start))
    clock = WallClock()
    robot = DeviceRobot(load_robot(devices.robot_file(folder, _PATIENT)), clock, start)
    stack.callback(robot.close)
    robot.wait_until_ready()
    return Rig(
        "wire",
        robot,
        clock,
        start,
        lambda: Pose2D(*devices.plant.motion.true),
        stale=1.0,
        jump=0.02,
        slack=0.15,
        linear_error=0.01,
        angular_error=0.03,
        angle_error=0.005,
        turning_error=0.05,
    )


def _hardware(stack: ExitStack, folder: Path, start: Pose2D) -> Rig:
    clock, origin = WallClock(), Pose2D(0.0, 0.0)
    robot = DeviceRobot(load_robot(HARDWARE), clock, origin)
    stack.callback(robot.close)
    robot.wait_until_ready()
    return Rig(
        "hardware",
        robot,
        clock,
        origin,
        cruise=0.15,
        spin=0.4,
        sweep=0.35,
        stale=0.5,
        jump=0.03,
        slack=0.15,
        linear_error=0.03,
        angular_error=0.1,
        angle_error=0.01,
    )


def _robot_file(folder: Path, devices: str = "") -> Path:
    path = folder / "conformance.robot.yaml"
    path.write_text(ROBOT + devices, encoding="utf-8")
    return path
