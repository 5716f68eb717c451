from __future__ import annotations

import socket
import time
from collections.abc import Callable, Iterator
from contextlib import closing

import pytest

from drivers.pan_tilt.states import State
from sim.devices.fault_desk import HELP, FaultDesk
from sim.devices.serve import SimulatedDevices
from sim.world_file import load_world
from sim.worlds import builtin_world
from zavis_bt.cli.files import load_robot_spec
from zavis_bt.errors import InputError

PATIENCE = 20.0


@pytest.fixture(scope="module")
def devices() -> Iterator[SimulatedDevices]:
    world = load_world(builtin_world("flat"))
    with SimulatedDevices(world, load_robot_spec("pioneer3at_sim"), world.starts[0]) as served:
        yield served


@pytest.fixture
def desk(devices) -> Iterator[FaultDesk]:
    with closing(FaultDesk(devices)) as made:
        yield made
        made.do("mend")


def becomes(condition: Callable[[], bool]) -> bool:
    end = time.monotonic() + PATIENCE
    while not condition() and time.monotonic() < end:
        time.sleep(0.01)
    return condition()


def listens(port: int) -> bool:
    try:
        socket.create_connection(("127.0.0.1", port), timeout=1.0).close()
    except ConnectionRefusedError:
        return False
    return True


def test_an_emergency_stop_is_pressed_and_released_by_itself(desk, devices):
    assert desk.do("estop 0.2") == "estop for 0.2 s"
    assert devices.plant.estop
    assert desk.faults == ("estop",)
    assert becomes(lambda: not devices.plant.estop)
    assert becomes(lambda: not desk.faults)


def test_a_fault_without_seconds_lasts_until_mend(desk, devices):
    assert desk.do("LIDAR  silent").endswith("(until mend)")
    assert devices.lidar.silent
    assert desk.do("mend") == "mended: lidar silent"
    assert not devices.lidar.silent
    assert desk.do("mend") == "nothing was broken"


def test_the_same_fault_again_replaces_its_time(desk, devices):
    desk.do("estop 0.2")
    desk.do("estop")
    time.sleep(0.4)
    assert devices.plant.estop


@pytest.mark.parametrize("kind", ["base", "lidar", "camera"])
def test_a_cut_line_comes_back_with_mend(desk, devices, kind):
    port = getattr(devices, kind).port
    desk.do(f"{kind} cut")
    desk.do(f"{kind} cut 100")
    assert not listens(port)
    assert desk.faults == (f"{kind} cut",)
    desk.do("mend")
    assert listens(port)


def test_a_frozen_camera_takes_pictures_again(desk, devices):
    desk.do("camera freeze")
    before, _ = devices.camera._shutter.newer_than(-1, 0.0)
    assert devices.camera._shutter.newer_than(before, 0.3) == (before, None)
    desk.do("mend")
    number, frame = devices.camera._shutter.newer_than(before, PATIENCE)
    assert number > before
    assert frame is not None


@pytest.mark.parametrize(("text", "level"), [("battery 0.05", 0.05), ("battery 5%", 0.05), ("battery 0", 0.0)])
def test_the_battery_is_what_it_is_set_to(desk, devices, text, level):
    desk.do(text)
    assert devices.plant.charge == pytest.approx(level)
    desk.do("battery 1")
    assert devices.plant.charge == 1.0
    assert not desk.faults


def test_an_emergency_brings_one_drive_down(desk, devices):
    assert desk.do("emcy tilt 7320") == "emergency 7320 of tilt"
    assert becomes(lambda: devices.pan_tilt.state("tilt") in (State.FAULT, State.FAULT_REACTION))
    assert devices.pan_tilt.state("pan") not in (State.FAULT, State.FAULT_REACTION)
    desk.do("can restart tilt")
    assert becomes(lambda: devices.pan_tilt.state("tilt") is State.SWITCH_ON_DISABLED)


def test_both_drives_can_be_cut_off_the_bus(desk, devices):
    assert desk.do("can silent both 60").splitlines() == ["can silent pan for 60 s", "can silent tilt for 60 s"]
    assert devices.pan_tilt._silent.keys() == {1, 2}
    desk.do("mend")
    assert not devices.pan_tilt._silent


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("lydar silent", "did you mean 'lidar'"),
        ("lidar", "silent or cut?"),
        ("lidar freeze", "silent or cut?"),
        ("camera silent", "freeze or cut?"),
        ("base silent", "cut?"),
        ("base cut soon", "seconds"),
        ("base cut -1", "seconds"),
        ("base cut nan", "seconds"),
        ("lidar silent 1 2", "seconds"),
        ("can silent", "which axis"),
        ("can silent roll", "which axis"),
        ("can break pan", "silent or restart?"),
        ("can restart pan 5", "not understood"),
        ("emcy", "which axis"),
        ("emcy pan 8z11", "hexadecimal"),
        ("emcy pan 0", "hexadecimal"),
        ("battery", "state of charge"),
        ("battery 1.5", "state of charge"),
        ("battery full", "state of charge"),
        ("mend lidar", "not understood"),
    ],
)
def test_what_is_no_command_is_told_and_breaks_nothing(desk, text, says):
    with pytest.raises(InputError, match=says.replace("?", r"\?")):
        desk.do(text)
    assert desk.faults == ()


def test_every_command_of_the_help_is_known(desk):
    assert desk.do("help") == HELP
    for line in HELP.splitlines()[:-1]:
        word = line.split()[0]
        if not line.startswith(" "):
            assert word in desk._commands
    assert desk.do("   ") == ""
