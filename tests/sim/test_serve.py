from __future__ import annotations

import random
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import closing

import pytest

from sim.devices.serve import Places, SimulatedDevices
from sim.world import World
from sim.world_file import load_world
from sim.worlds import builtin_world
from zavis_bt.cli.files import load_robot_spec
from zavis_bt.errors import DeviceError
from zavis_bt.mission.clock import WallClock
from zavis_bt.mission.device_robot import DeviceRobot, open_device
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.types import Twist2D

PATIENCE = 20.0


@pytest.fixture(scope="module")
def world() -> World:
    return load_world(builtin_world("flat"))


@pytest.fixture(scope="module")
def devices(world) -> Iterator[SimulatedDevices]:
    with SimulatedDevices(world, load_robot_spec("pioneer3at_sim"), world.starts[0]) as served:
        yield served


def becomes(condition: Callable[[], bool]) -> bool:
    end = time.monotonic() + PATIENCE
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


def refused(port: int) -> bool:
    try:
        socket.create_connection(("127.0.0.1", port), timeout=1.0).close()
    except ConnectionRefusedError:
        return True
    return False


def test_the_robot_file_that_is_written_holds_the_same_model(devices, tmp_path):
    assert load_robot(devices.robot_file(tmp_path)).spec == devices.plant.spec


def test_further_settings_go_into_the_robot_file(devices, tmp_path):
    file = load_robot(devices.robot_file(tmp_path, {"base": {"command_timeout": 0.3}}))
    settings = devices.settings()["base"]["settings"]
    assert settings["port"] == f"tcp://127.0.0.1:{devices.base.port}"
    assert file.devices["base"].settings == {**settings, "command_timeout": 0.3}


def test_the_drivers_find_all_devices_and_drive_the_body(devices, tmp_path):
    clock = WallClock()
    robot = DeviceRobot(load_robot(devices.robot_file(tmp_path)), clock)
    try:
        robot.wait_until_ready(PATIENCE)
        assert becomes(lambda: set(devices.clients().values()) == {1})
        before = devices.plant.motion.travelled
        robot.pan_tilt.move_to(0.2, 0.1)

        def driven() -> bool:
            robot.base.command(Twist2D(0.2, 0.0))
            return devices.plant.motion.travelled > before + 0.1

        assert becomes(driven)
        robot.base.stop()
        assert becomes(lambda: robot.pan_tilt.state().settled and devices.plant.joints(devices.plant.now)[0] > 0.19)
        assert robot.lidar.scan() is not None
        assert robot.camera.frame() is not None
    finally:
        robot.close()
    assert becomes(lambda: set(devices.clients().values()) == {0})


@pytest.mark.parametrize("kind", ["base", "lidar", "camera"])
def test_a_line_that_was_cut_refuses_clients_until_it_is_reconnected(devices, kind):
    port = getattr(devices, kind).port
    devices.cut(kind)
    assert refused(port)
    devices.reconnect(kind)
    assert getattr(devices, kind).port == port
    assert not refused(port)


def test_nothing_listens_any_more_once_it_is_closed(world):
    with SimulatedDevices(world, load_robot_spec("pioneer3at_sim"), world.starts[0], serial=True) as served:
        ports = [served.base.port, served.lidar.port, served.camera.port]
        assert len(set(ports)) == 3
        assert served.serial is not None
        assert served.serial.path.startswith("/dev/")
    assert all(refused(port) for port in ports)
    served.close()


@pytest.mark.parametrize("kind", ["base", "lidar", "camera"])
def test_a_port_that_is_taken_is_told_and_the_others_are_free_again(devices, world, kind):
    taken = getattr(devices, kind).port
    with pytest.raises(DeviceError, match=f":{taken}: "):
        SimulatedDevices(world, devices.plant.spec, world.starts[0], places=Places(**{kind: taken}))


def test_a_robot_that_is_called_a_pioneer_3_dx_answers_as_one(world, tmp_path):
    with SimulatedDevices(world, load_robot_spec("pioneer3dx_hardware"), world.starts[0]) as served:
        base = open_device(load_robot(served.robot_file(tmp_path)), "base", WallClock())
        assert "p3dx" in base.report().model
        base.close()


def test_a_bus_that_does_not_exist_is_one_line_and_everything_is_closed(world):
    served = SimulatedDevices(
        world, load_robot_spec("pioneer3at_sim"), world.starts[0], places=Places(can_interface="no-such-bus")
    )
    port = served.base.port
    with pytest.raises(DeviceError, match=r"CAN bus no-such-bus .*--can"):
        served.start()
    assert refused(port)


def test_a_second_simulator_on_the_same_bus_is_refused(world):
    port = random.Random().randrange(20_000, 60_000)
    places = Places(can_interface="udp_multicast", can_channel="239.74.163.2", can_options={"port": port})
    spec = load_robot_spec("pioneer3at_sim")
    first = SimulatedDevices(world, spec, world.starts[0], places=places)
    first.start()
    with closing(first), pytest.raises(DeviceError, match="node 1 is there already"):
        SimulatedDevices(world, spec, world.starts[0], places=places).start()
