from __future__ import annotations

import json
import math
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from served_robot import served
from typer.testing import CliRunner, Result

from sim.devices.fault_desk import FaultDesk
from sim.devices.serve import SimulatedDevices
from sim.simulation import Simulation
from sim.world_file import load_world
from sim.worlds import builtin_world
from zavis_bt.cli.checkup import Watch, frame_problems, scan_problems
from zavis_bt.cli.files import load_robot_spec
from zavis_bt.cli.main import app
from zavis_bt.cli.motion_trial import BaseTrial, try_pan_tilt
from zavis_bt.mission import SafetySettings
from zavis_bt.types import CameraIntrinsics, LaserScan, PanTiltState, Pose2D, RgbdFrame, Twist2D, wrap_angle

SPEC = load_robot_spec("pioneer3at")


def doctor(*args: object, answer: str = "") -> Result:
    return CliRunner().invoke(app, ["doctor", *map(str, args)], input=answer)


def doctor_until_well(*args: object, answer: str = "") -> Result:
    """Ask again where this computer was too busy for a device to be well."""
    for _ in range(6):
        result = doctor(*args, answer=answer)
        if result.exit_code == 0:
            break
    return result


@pytest.fixture(scope="module")
def devices() -> Iterator[SimulatedDevices]:
    with served() as made:
        yield made


@pytest.fixture
def desk(devices) -> Iterator[FaultDesk]:
    with closing(FaultDesk(devices)) as made:
        yield made
        made.do("mend")


@pytest.fixture
def robot_file(devices, tmp_path) -> Path:
    return devices.robot_file(tmp_path)


def test_a_robot_that_is_well_is_said_to_be(robot_file):
    result = doctor_until_well("--robot", robot_file, "--seconds", 0.5)
    assert result.exit_code == 0, result.output
    for word in ("p3at-sh", "UST-10LX", "firmware", "Hz", "battery", "all well: base, pan_tilt, lidar, camera"):
        assert word in " ".join(result.output.split())


def test_findings_come_as_one_line_of_json(robot_file):
    result = doctor_until_well("--robot", robot_file, "--seconds", 0.5, "--only", "lidar,base", "--json")
    assert result.exit_code == 0, result.output
    findings = json.loads(result.stdout)
    assert findings["ok"]
    assert list(findings["devices"]) == ["base", "lidar"]
    assert findings["devices"]["base"]["serial"] == "SIM-3AT"
    assert 10 < float(findings["devices"]["lidar"]["figures"]["rate"].split()[0]) < 24


def test_nothing_moves(devices, robot_file):
    before = devices.plant.motion.travelled, devices.plant.motion.true
    doctor("--robot", robot_file, "--seconds", 0.2, "--only", "base,pan_tilt")
    assert (devices.plant.motion.travelled, devices.plant.motion.true) == before


def test_a_device_that_is_not_there_does_not_keep_others_from_being_checked(robot_file, desk):
    desk.do("base cut")
    result = doctor("--robot", robot_file, "--seconds", 0.2, "--only", "base,lidar")
    assert result.exit_code == 1
    assert "nothing listens there" in result.output
    assert "UST-10LX" in result.output
    assert "not well: base" in result.output
    assert str(robot_file) not in result.output.split("base")[-1]


@pytest.mark.parametrize(
    ("fault", "kind", "says"),
    [("estop", "base", "stop button"), ("battery 0.1", "base", "battery"), ("camera freeze", "camera", "frame")],
)
def test_what_is_wrong_is_said_in_plain_words(robot_file, desk, fault, kind, says):
    desk.do(fault)
    result = doctor("--robot", robot_file, "--seconds", 0.8 if kind == "camera" else 0.2, "--only", kind, "--json")
    assert result.exit_code == 1, result.output
    problems = json.loads(result.stdout)["devices"][kind]["problems"]
    assert any(says in problem.lower() for problem in problems), problems


def test_with_move_it_asks_and_then_moves_there_and_back(devices, robot_file):
    before = devices.plant.motion
    result = doctor_until_well("--robot", robot_file, "--seconds", 0.3, "--only", "base,lidar", "--move", answer="y\n")
    assert result.exit_code == 0, result.output
    after = devices.plant.motion
    assert after.travelled - before.travelled > 0.15
    assert math.dist(after.true[:2], before.true[:2]) < 0.1
    assert "moves as it is told" in result.output


@pytest.mark.parametrize("answer", ["n\n", ""])
def test_nothing_is_done_without_a_yes(devices, robot_file, answer):
    before = devices.plant.motion.travelled
    result = doctor("--robot", robot_file, "--move", answer=answer)
    assert result.exit_code == 1
    assert "not confirmed" in result.output
    assert devices.plant.motion.travelled == before


def test_the_base_is_not_moved_without_a_lidar_that_is_well(devices, robot_file):
    before = devices.plant.motion.travelled
    result = doctor("--robot", robot_file, "--seconds", 0.3, "--only", "base", "--move", answer="y\n")
    assert result.exit_code == 1
    assert "needs a LiDAR" in result.output
    assert devices.plant.motion.travelled == before


def test_without_a_robot_the_computer_is_looked_at():
    result = doctor()
    assert result.exit_code == 0
    for word in ("Python", "serial ports", "CAN interfaces", "--robot"):
        assert word in result.output


@pytest.mark.parametrize(
    ("args", "says"),
    [
        (("--robot", "pioneer3at"), "has no devices"),
        (("--robot", "pioneer3at_sin"), "did you mean 'pioneer3at_sim'"),
        (("--robot", "pioneer3at_sim", "--only", "ladir"), "did you mean 'lidar'"),
    ],
)
def test_a_wrong_argument_is_one_line(args, says):
    result = doctor(*args)
    assert result.exit_code == 1
    assert says in result.output
    assert len(result.output.strip().splitlines()) == 1


# -- small motions -----------------------------------------------------------------------------------------------------


def simulation(start: Pose2D | None = None) -> Simulation:
    world = load_world(builtin_world("flat"))
    return Simulation(world, SPEC, start or world.starts[0])


def test_the_base_comes_back_to_where_it_was():
    moved = simulation()
    before = moved.truth
    assert BaseTrial(moved.robot, SafetySettings(), moved.clock).run() == []
    assert moved.path_length > 0.2
    assert moved.truth.distance(before) < 0.05
    assert abs(wrap_angle(moved.truth.yaw - before.yaw)) < math.radians(6)


def test_a_base_before_a_wall_is_held_back_and_says_so():
    moved = simulation()
    x, y = moved.truth.x, moved.truth.y
    for _ in range(400):
        moved.robot.base.command(Twist2D(0.3, 0.0))
        moved.clock.wait_until(moved.clock.now() + 0.1)
    assert (moved.truth.x, moved.truth.y) != (x, y)
    told = BaseTrial(moved.robot, SafetySettings(), moved.clock).run()
    assert "held back" in told[0]


def test_the_pan_tilt_unit_nods_and_comes_back_even_at_its_limit():
    moved = simulation()
    unit = moved.robot.pan_tilt
    for pan in (0.0, SPEC.pan_tilt.pan_max):
        unit.move_to(pan, 0.0)
        moved.clock.wait_until(moved.clock.now() + 10.0)
        assert try_pan_tilt(unit, SPEC.pan_tilt, moved.clock) == []
        assert unit.state().pan == pytest.approx(pan)


def test_a_unit_that_does_not_move_is_told():
    moved = simulation()

    class Stuck:
        def state(self) -> PanTiltState:
            return PanTiltState(0.0, 0.0, False, moved.clock.now())

        def move_to(self, pan: float, tilt: float) -> None:
            """Stay."""

        def stop(self) -> None:
            """Stay."""

    told = try_pan_tilt(Stuck(), SPEC.pan_tilt, moved.clock)
    assert "pan/tilt 10°/10° and is at 0°/0°" in told[0]


# -- judging -----------------------------------------------------------------------------------------------------------


def test_rate_age_and_gaps_follow_from_the_stamps():
    watch = Watch()
    for stamp in (1.0, 1.0, 1.1, 1.2, 1.5):
        watch.note(stamp, stamp + 0.02)
    watch.note(None, 9.0)
    assert watch.rate == pytest.approx(6.0)
    assert watch.longest_gap == pytest.approx(0.3)
    assert watch.figures()["age when it arrives"] == "20 ms, at most 20 ms"


@pytest.mark.parametrize(
    ("ranges", "says"),
    [
        (np.full(181, np.inf), "no beam returns"),
        (np.where(np.arange(181) % 3, 1.0, np.nan), "broken"),
        (np.full(91, 1.0), "spans 90°"),
    ],
)
def test_scans_that_cannot_be_right_are_told(ranges, says):
    scan = LaserScan(ranges, SPEC.lidar.angle_min, math.radians(1.0), 0.05, 10.0, 0.0)
    assert any(says in problem for problem in scan_problems(scan, SPEC))


def test_frames_that_cannot_be_right_are_told():
    wanted = SPEC.camera.intrinsics
    black = np.zeros((240, 320, 3), dtype=np.uint8), np.zeros((240, 320), dtype=np.float32)
    small = CameraIntrinsics.from_fov(320, 240, wanted.horizontal_fov)
    told = " ".join(frame_problems(RgbdFrame(small, np.eye(4), 0.0, lambda: black), SPEC))
    for words in ("320 x 240", "black", "no depth"):
        assert words in told
    assert list(frame_problems(None, SPEC)) == ["no frame arrived"]
