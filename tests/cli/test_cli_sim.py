from __future__ import annotations

import random
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from served_robot import PATIENCE, person, served
from typer.testing import CliRunner

from sim.devices.fault_desk import FaultDesk
from sim.devices.serve import SimulatedDevices
from zavis_bt.cli.main import app
from zavis_bt.cli.serving import status
from zavis_bt.cli.truth import Truth
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.viz.scene import Scene

FREE = ("--base-port", "0", "--lidar-port", "0", "--camera-port", "0")


def own_bus() -> tuple[str, str]:
    return "--can", f"udp_multicast:239.74.163.2:{random.Random().randrange(20_000, 60_000)}"


@pytest.fixture(scope="module")
def devices() -> Iterator[SimulatedDevices]:
    with served() as made:
        yield made


def test_commands_come_through_a_pipe_and_quit_ends(tmp_path):
    path = tmp_path / "my.robot.yaml"
    done = subprocess.run(
        [sys.executable, "-m", "zavis_bt", "sim", "serve", "flat", *FREE, *own_bus(), "--write-robot", path],
        input="lidar silent 1\nlidr silent\nquit\n",
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    for words in ("ARCOS", "SCIP 2.0", "CiA 402", f"--robot {path}", "lidar silent for 1 s", "did you mean 'lidar'"):
        assert words in done.stdout
    ports = [str(device.settings.get("port")) for device in load_robot(path).devices.values()]
    assert sum(port in done.stdout for port in ports) == 3


def test_it_serves_on_without_standard_input_until_it_is_told_to_end(tmp_path):
    path = tmp_path / "my.robot.yaml"
    serving = subprocess.Popen(
        [sys.executable, "-m", "zavis_bt", "sim", "serve", "flat", *FREE, *own_bus(), "--write-robot", path],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert serving.stdout is not None
        assert any("in another terminal" in line for line in serving.stdout)
        checked = CliRunner().invoke(app, ["doctor", "--robot", str(path), "--seconds", "0.3"])
        assert checked.exit_code == 0, checked.output
        serving.send_signal(signal.SIGTERM)
        _, errors = serving.communicate(timeout=PATIENCE)
        assert serving.returncode == 143
        assert "Traceback" not in errors
    finally:
        serving.kill()
        serving.communicate()


def test_at_a_terminal_there_is_a_status_and_faults_are_typed():
    with person("sim", "serve", "flat", *FREE, *own_bus()) as somebody:
        assert somebody.sees("camera ○"), somebody.seen
        somebody.type("estop 60x\x7f\n")
        assert somebody.sees("estop for 60 s"), somebody.seen
        assert somebody.sees("✗ estop  x"), somebody.seen
        somebody.type("\x03")
        assert somebody.exit_code() == 130
        assert somebody.leaves_the_terminal_as_it_was()
    assert "Traceback" not in somebody.seen


def test_the_status_tells_where_the_robot_is_who_is_connected_and_what_is_broken(devices):
    desk = FaultDesk(devices)
    desk.do("battery 5%")
    line = status(devices, desk)
    for words in ("m/s", "pan 0° tilt 0°", "base ○", "lidar ○", "camera ○", "battery 5%"):
        assert words in line
    desk.do("mend")
    desk.close()


def test_the_truth_can_be_drawn(devices):
    from sim.world_file import load_world
    from sim.worlds import builtin_world

    truth = Truth(devices, load_world(builtin_world("flat")))
    truth.update()
    drawn = {message.name for message in Scene().news(truth, 0.0, everything=True)}
    assert any("map/walls" in path for path in drawn)
    assert any("robot" in path for path in drawn)


@pytest.mark.parametrize(
    ("args", "says"),
    [
        (("flot",), "did you mean 'flat'"),
        (("flat", "--robot", "lokobot"), "did you mean 'locobot'"),
        (("flat", "--start", "1,2"), "x,y,yaw"),
        (("flat", "--start", "500,2,0"), "outside the map"),
        (("flat", "--can", "can0"), "KIND:CHANNEL"),
        (("flat", "--write-robot", "/no/such/folder/robot.yaml"), "cannot be written"),
    ],
)
def test_a_wrong_argument_is_one_line(args, says):
    result = CliRunner().invoke(app, ["sim", "serve", *args, *FREE, *(() if "--can" in args else own_bus())])
    assert result.exit_code == 1, result.output
    assert says in result.output
    assert len(result.output.strip().splitlines()) == 1


def test_a_port_that_is_taken_is_one_line_with_the_remedy(devices):
    result = CliRunner().invoke(app, ["sim", "serve", "flat", "--lidar-port", str(devices.lidar.port), *own_bus()])
    assert result.exit_code == 1
    assert "--lidar-port" in result.output
    assert len(result.output.strip().splitlines()) == 1


def test_the_seed_chooses_the_start_and_the_words_for_other_terminals_name_it(tmp_path, monkeypatch):
    monkeypatch.setattr("zavis_bt.cli.serving.attend", lambda *args, **kwargs: None)
    outputs = []
    for seed in (0, 1):
        path = Path(tmp_path / "my.robot.yaml")
        args = ["sim", "serve", "apartment", "--seed", str(seed), *FREE, "--can", "virtual:seeds"]
        result = CliRunner().invoke(app, [*args, "--write-robot", str(path)])
        assert result.exit_code == 0, result.output
        outputs.append(next(line for line in result.output.splitlines() if "--start" in line))
    assert outputs[0] != outputs[1]
