from __future__ import annotations

import math
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from served_robot import person, served
from typer.testing import CliRunner

from sim.devices.robot_file import write_robot_file
from sim.devices.serve import SimulatedDevices
from sim.simulation import Simulation
from sim.world_file import load_world
from sim.worlds import builtin_world
from zavis_bt.cli.drive import Drive
from zavis_bt.cli.drive_view import state_line, word_line
from zavis_bt.cli.files import load_robot_spec
from zavis_bt.cli.main import app
from zavis_bt.cli.teleop import Look, Teleop
from zavis_bt.mission import SafetySettings
from zavis_bt.types import Pose2D, Twist2D

SPEC = load_robot_spec("pioneer3at")


# -- what keys mean --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "forward", "turn"),
    [("w", 1, 0), ("up", 1, 0), ("s", -1, 0), ("down", -1, 0), ("a", 0, 1), ("left", 0, 1), ("d", 0, -1)],
)
def test_a_key_moves_the_base_only_for_as_long_as_it_is_heard_of(key, forward, turn):
    teleop = Teleop(SPEC.limits, hold=0.5)
    assert teleop.twist(0.0) is None
    teleop.press(key, 1.0)
    twist = teleop.twist(1.4)
    assert twist is not None
    assert math.copysign(1, twist.linear) == forward or not forward
    assert math.copysign(1, twist.angular) == turn or not turn
    assert teleop.twist(1.6) is None


@pytest.mark.parametrize("key", [" ", "x", "other", "\x1a", "q"])
def test_any_other_key_stops(key):
    teleop = Teleop(SPEC.limits)
    teleop.press("w", 0.0)
    teleop.press(key, 0.1)
    assert teleop.twist(0.1) is None


@pytest.mark.parametrize("key", ["+", "-"])
def test_the_speed_stays_slow_and_above_standstill(key):
    teleop = Teleop(SPEC.limits)
    for _ in range(50):
        teleop.press(key, 0.0)
    teleop.press("w", 0.0)
    forward = teleop.twist(0.0)
    assert forward is not None
    assert 0.04 < forward.linear <= 0.3
    teleop.press("a", 0.0)
    turning = teleop.twist(0.0)
    assert turning is not None
    assert 0 < turning.angular <= min(SPEC.limits.max_angular, math.radians(60) + 1e-9)


def test_keys_for_the_camera_leave_the_base_as_it_is():
    teleop = Teleop(SPEC.limits)
    teleop.press("w", 0.0)
    assert teleop.press("j", 0.1) == Look(math.radians(5), 0.0)
    assert teleop.press("h", 0.1) == Look(0.0, 0.0, level=True)
    assert teleop.twist(0.1) is not None


# -- the loop --------------------------------------------------------------------------------------------------------


def drive_at(start: Pose2D | None = None) -> tuple[Simulation, Drive]:
    world = load_world(builtin_world("flat"))
    simulation = Simulation(world, SPEC, start or world.starts[0])
    return simulation, Drive(simulation.robot, simulation.clock, Teleop(SPEC.limits), SafetySettings())


def ticks(simulation: Simulation, drive: Drive, keys: list[list[str]]) -> None:
    for pressed in keys:
        drive.tick(pressed)
        simulation.clock.wait_until(simulation.clock.now() + 0.05)


def test_the_base_moves_while_the_key_repeats_and_stands_afterwards():
    simulation, drive = drive_at()
    ticks(simulation, drive, [["a"]] * 20)
    assert simulation.robot.base.state().twist.angular == pytest.approx(drive.teleop.turn)
    assert "turns left" in word_line(drive).plain
    ticks(simulation, drive, [[]] * 40)
    assert simulation.robot.base.state().twist == Twist2D()
    assert "stands" in word_line(drive).plain


def test_a_key_without_a_meaning_stops_as_fast_as_the_base_can():
    simulation, drive = drive_at()
    ticks(simulation, drive, [["w"]] * 20)
    assert simulation.robot.base.state().twist.linear > 0.1
    ticks(simulation, drive, [[" "], [], []])
    assert simulation.robot.base.state().twist.linear == 0.0
    ticks(simulation, drive, [["w"]] * 10)
    assert simulation.robot.base.state().twist.linear > 0.1


def test_the_robot_is_not_driven_into_what_the_lidar_sees():
    simulation, drive = drive_at()
    ticks(simulation, drive, [["w"]] * 1500)
    assert simulation.collisions == 0
    assert simulation.robot.base.state().twist.linear == pytest.approx(0.0, abs=0.02)
    assert "held back: obstacle" in word_line(drive).plain


def test_the_camera_turns_while_its_key_repeats_and_comes_back_to_level():
    simulation, drive = drive_at()
    ticks(simulation, drive, [["j"]] * 20 + [[]] * 20)
    pan = simulation.robot.pan_tilt.state().pan
    assert math.radians(5) <= pan <= math.radians(100)
    ticks(simulation, drive, [["h"]] + [[]] * 60)
    assert simulation.robot.pan_tilt.state().pan == pytest.approx(0.0)


def test_the_line_tells_of_pose_speed_battery_and_the_nearest_obstacle():
    _, drive = drive_at()
    drive.tick([])
    line = state_line(drive).plain
    for word in ("x ", "m/s", "battery 100%", "nearest", "pan 0°"):
        assert word in line


# -- the command -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def devices() -> Iterator[SimulatedDevices]:
    with served() as made:
        yield made


@pytest.fixture
def robot_file(devices, tmp_path) -> Path:
    """A robot without pan-tilt unit and camera."""
    path = tmp_path / "small.robot.yaml"
    chosen = {kind: setting for kind, setting in devices.settings().items() if kind in ("base", "lidar")}
    write_robot_file(path, devices.plant.spec, chosen)
    return path


def test_a_robot_over_the_wire_is_driven_from_the_keyboard(devices, robot_file):
    with person("drive", "--robot", robot_file) as driver:
        assert driver.sees("stands: hold a key")
        assert driver.until(lambda: abs(devices.plant.motion.angular) > 0.2, keys="a"), driver.seen
        assert driver.until(lambda: devices.plant.motion.angular == 0.0)
        assert driver.process.poll() is None
        driver.type("q")
        assert driver.exit_code() == 0, driver.seen
        assert driver.leaves_the_terminal_as_it_was()
    assert "turns left" in driver.seen


@pytest.mark.parametrize(("way", "code"), [("SIGTERM", 143), ("hang up", 129)])
def test_however_it_ends_the_base_stands_and_the_terminal_is_as_it_was(devices, robot_file, way, code):
    with person("drive", "--robot", robot_file) as driver:
        assert driver.until(lambda: abs(devices.plant.motion.angular) > 0.2, keys="d"), driver.seen
        if way == "SIGTERM":
            driver.process.send_signal(signal.SIGTERM)
        else:
            driver.hang_up()
        assert driver.exit_code() == code, driver.seen
        assert devices.base.firmware.phase.name == "SYNC0"  # it has said goodbye, which stops the motors
        if way != "hang up":
            assert driver.leaves_the_terminal_as_it_was()
        assert driver.until(lambda: devices.plant.motion.angular == 0.0) or devices.plant.motion.angular == 0.0


@pytest.mark.parametrize(
    ("args", "says"),
    [
        ((), "not a terminal"),
        (("--robot", "pionier3at"), "did you mean 'pioneer3at'"),
    ],
)
def test_what_cannot_be_driven_is_one_line(args, says):
    result = CliRunner().invoke(app, ["drive", *args])
    assert result.exit_code == 1
    assert says in result.output
    assert len(result.output.strip().splitlines()) == 1


def test_a_robot_that_is_not_there_is_one_line_with_the_remedy(devices, robot_file):
    text = robot_file.read_text().replace(f":{devices.base.port}", ":9")
    robot_file.write_text(text)
    with person("drive", "--robot", robot_file) as driver:
        assert driver.exit_code() == 1
    assert "nothing listens there" in driver.seen
    assert "Traceback" not in driver.seen
