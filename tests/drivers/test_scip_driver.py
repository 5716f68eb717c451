from __future__ import annotations

import contextlib
import math
import socket
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from scip_bench import (
    PIONEER,
    START,
    SerialSensor,
    address,
    around,
    context,
    hall,
    opened,
    robot,
    served,
    wait_for,
)

from benchmarks.chaos import proxied
from drivers.lidar import open_lidar
from drivers.lidar.codec import CLOCK_SPAN
from sim.simulation import Simulation
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.protocols import Device, Lidar


def same(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether ranges agree within the sensor's millimetre."""
    return np.allclose(one, other, rtol=0, atol=0.00051, equal_nan=True)


@pytest.mark.parametrize(
    "lidar",
    [
        {},
        {**around(270, 1081), "rate": 40.0, "range_min": 0.02},
        around(360, 360),
        {"range_min": 1.6, "range_max": 4.0},
    ],
    ids=["pioneer", "ust", "whole turn", "near-sighted"],
)
def test_scans_are_those_of_the_simulators_own_lidar(lidar):
    spec = robot(**lidar)
    expected = Simulation(hall(), spec, START).robot.lidar.scan()
    with served(spec) as server, opened(address(server.port), context(spec)) as device:
        wait_for(device.scan)
        scan = device.scan()
        assert device.report().problems == ()
    assert same(scan.ranges, expected.ranges)
    assert scan.angles == pytest.approx(expected.angles)
    assert (scan.range_min, scan.range_max) == (expected.range_min, expected.range_max)


def test_a_sensor_upside_down_is_turned_round():
    with served() as server:
        with opened(address(server.port)) as upright:
            wait_for(upright.scan)
        with opened(address(server.port), flipped=True) as hanging:
            wait_for(hanging.scan)
    assert np.array_equal(upright.scan().ranges, hanging.scan().ranges[::-1], equal_nan=True)


def test_clusters_give_the_nearest_of_neighbours():
    with served() as server, opened(address(server.port), cluster=5) as device:
        wait_for(device.scan)
        scan = device.scan()
        assert any("36 beams 5° apart" in line for line in device.report().problems)
    every = Simulation(hall(), PIONEER, START).robot.lidar.scan().ranges[:180]
    assert same(scan.ranges, every.reshape(36, 5).min(axis=1))
    assert scan.angle_min == pytest.approx(math.radians(-88))


def test_scans_are_fresh_and_their_stamps_a_turn_apart_when_the_sensors_clock_wraps():
    spec, told = robot(rate=40.0), context(robot(rate=40.0))
    with served(spec, uptime=CLOCK_SPAN / 1000 - 0.5) as server, opened(address(server.port), told) as device:
        wait_for(device.scan)
        stamps = []
        while len(stamps) < 40:
            wait_for(lambda: device.scan().stamp not in stamps)
            stamps.append(device.scan().stamp)
            assert -1e-6 <= told.clock.now() - stamps[-1] < 1.0
        assert device.report().figures["clock"] == "synchronised"
    assert (np.diff(stamps) > 0).all()
    assert stamps[-1] - stamps[0] >= 39 * 0.025 - 0.045  # those in between may have been missed


def test_scans_cannot_be_changed_and_stay_the_same_object_until_the_next():
    with served() as server, opened(address(server.port)) as device:
        wait_for(device.scan)
        scan = device.scan()
    assert (scan.ranges.dtype, scan.ranges.flags.writeable) == (np.float64, False)
    assert device.scan() is device.scan()


def test_the_device_keeps_to_its_protocols():
    with served() as server, opened(address(server.port)) as device:
        lidar: Lidar = device
        kept: Device = device
        assert callable(lidar.scan)
        assert callable(kept.report)


def test_the_report_has_a_name_plate_and_figures():
    with served() as server, opened(address(server.port)) as device:
        wait_for(lambda: device.report().figures["rate"] != "0.0 Hz")
        report = device.report()
    assert (report.model, report.firmware, report.serial) == ("UST-10LX", "1.0.0(simulated)", "H0000001")
    assert report.figures["beams"] == "181 of 1°"
    assert report.figures["range"] == "0.05 to 10 m"
    assert report.figures["checksum errors"] == report.figures["reconnects"] == "0"


def test_closing_ends_the_stream_and_frees_the_sensor():
    with served() as server:
        device = open_lidar({"port": address(server.port)}, context())
        wait_for(device.scan)
        device.close()
        device.close()
        last = device.scan()
        wait_for(lambda: server.clients == 0)
        assert not any(thread.name == "lidar" for thread in threading.enumerate())
        assert device.scan() is last
        with opened(address(server.port)) as again:
            wait_for(again.scan)


def test_a_silent_sensor_keeps_its_last_scan_and_comes_back():
    told = context()
    with served() as server, opened(address(server.port), told) as device:
        wait_for(device.scan)
        server.silent = True
        wait_for(lambda: device.report().problems)
        assert "no sound scan for 0.5 s" in device.report().problems[0]
        last = device.scan()
        assert told.clock.now() - last.stamp > 0.5
        server.silent = False
        wait_for(lambda: device.scan() is not last)
        assert device.scan().stamp > last.stamp
        wait_for(lambda: not device.report().problems)
        assert int(device.report().figures["reconnects"]) >= 1


def test_a_cut_line_is_mended_by_itself():
    with served() as server, proxied(("127.0.0.1", server.port)) as proxy, opened(address(proxy.port)) as device:
        wait_for(device.scan)
        proxy.cut()
        wait_for(lambda: any("nothing listens there" in line for line in device.report().problems))
        last = device.scan()
        proxy.mend()
        wait_for(lambda: device.scan() is not last)
        wait_for(lambda: not device.report().problems)


def test_scans_with_corrupted_bytes_are_dropped_and_counted():
    spec = robot(rate=40.0)
    truth = Simulation(hall(), spec, START).robot.lidar.scan().ranges
    with contextlib.ExitStack() as lines:
        server = lines.enter_context(served(spec))
        proxy = lines.enter_context(proxied(("127.0.0.1", server.port)))
        device = lines.enter_context(opened(address(proxy.port), context(spec)))
        wait_for(device.scan)
        proxy.corrupt(0.0005, np.random.default_rng(5))
        seen = []
        while device.report().figures["checksum errors"] == "0" or len(seen) < 20:
            assert len(seen) < 2000
            seen.append(device.scan())
            time.sleep(0.025)
        proxy.mend()
        assert all(same(scan.ranges, truth) for scan in seen)
        assert any("wrong checksums" in line for line in device.report().problems)
        last = device.scan()
        wait_for(lambda: device.scan() is not last)


def test_a_sensor_on_a_serial_line_is_driven():
    with SerialSensor() as sensor, opened(sensor.port) as device:
        wait_for(device.scan)
        assert same(device.scan().ranges, Simulation(hall(), PIONEER, START).robot.lidar.scan().ranges)
        assert b"SCIP2.0" not in sensor.heard
        device.close()
        assert sensor.heard.endswith(b"QT\n")


def test_an_old_sensor_is_brought_to_the_second_version():
    with SerialSensor(old=True) as sensor, opened(sensor.port) as device:
        wait_for(device.scan)
        assert b"SCIP2.0\n" in sensor.heard


@contextlib.contextmanager
def stranger(says: bytes) -> Iterator[str]:
    """Another device: says the same to everybody whenever it is spoken to."""
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def serve() -> None:
            with contextlib.suppress(OSError):
                peer, _ = listener.accept()
                with peer:
                    while peer.recv(4096):
                        peer.sendall(says)

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield address(listener.getsockname()[1])
        thread.join()


@pytest.mark.parametrize(
    ("says", "message"),
    [
        (b"", r"does not answer \(is it the LiDAR's port"),
        (
            b"HTTP/1.1 400 Bad Request\r\n\r\n",
            r"answers, but not in SCIP 2\.0: 'HTTP/1\.1 400 Bad Request' \(is it the",
        ),
        (b"\xfa\xfb\x03\x00\x00\x00", r"answers, but not in SCIP 2\.0: fa fb 03 00 00 00"),
        (b"QT\n00P\n\n", r"no answer to PP \(is the cable sound\?\)"),
    ],
)
def test_another_device_on_the_port_is_told_in_one_line(says, message):
    with stranger(says) as port, pytest.raises(DeviceError, match=message) as caught:
        open_lidar({"port": port}, context())
    assert str(caught.value).startswith(f"my.robot.yaml: devices.lidar: {port}: ")
    assert "\n" not in str(caught.value)


def test_a_port_where_nobody_listens_is_told_with_the_remedy():
    with socket.create_server(("127.0.0.1", 0)) as gone:
        port = gone.getsockname()[1]
    with pytest.raises(DeviceError, match="nothing listens there"):
        open_lidar({"port": address(port)}, context())


def test_a_sensor_that_serves_another_program_is_told_with_the_remedy():
    told = pytest.raises(DeviceError, match=r"the connection \(a LiDAR serves one program at a time")
    with served() as server, opened(address(server.port)), told:
        open_lidar({"port": address(server.port)}, context())


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({}, r"settings\.port: is missing"),
        ({"port": "tcp://x:1", "clustre": 2}, r"settings\.clustre: unknown setting \(did you mean 'cluster'"),
        ({"port": "tcp://x:1", "cluster": 0}, r"settings\.cluster: .* \(got 0\)"),
        ({"port": "tcp://x:1", "skip": 10}, r"settings\.skip: .* \(got 10\)"),
    ],
)
def test_wrong_settings_are_told_with_their_place(settings, message):
    with pytest.raises(InputError, match=message):
        open_lidar(settings, context())
