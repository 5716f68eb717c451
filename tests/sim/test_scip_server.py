from __future__ import annotations

import socket
import time
from collections.abc import Iterator

import numpy as np
import pytest
from scip_host import PATIENCE, START, Host

from sim.devices.plant import Plant
from sim.devices.scip import ScipServer
from zavis_bt.errors import DeviceError


@pytest.fixture
def server(room, spec) -> Iterator[ScipServer]:
    plant = Plant(room, spec, START)
    serving = ScipServer(plant)
    plant.start()
    serving.start()
    yield serving
    serving.close()
    plant.close()


def wait_until_free(server: ScipServer) -> None:
    end = time.monotonic() + PATIENCE
    while server.clients:
        assert time.monotonic() < end
        time.sleep(0.002)


def test_requests_are_answered_over_tcp_however_they_are_cut(server):
    with Host(server.port) as host:
        for piece in (b"\n", b"Q", b"T\nQT;a", b"bc\r"):
            host.say(piece)
        host.expect(b"QT\n00P\n\nQT;abc\n00P\n\n")


def test_nothing_of_a_stream_follows_the_end_of_it(server):
    with Host(server.port) as host:
        host.say(b"MD0000018001000\n")
        host.until(b"99b\n")
        host.say(b"QT\nVV\n")
        host.until(b"\nQT\n00P\n\n")
        assert host.until(b"\n\n").startswith(b"VV\n00P\n")


def test_scans_keep_coming(server):
    with Host(server.port) as host:
        host.say(b"MD0000018001000\n")
        scans = host.scans(5)
        assert all(np.array_equal(scan, scans[0]) for scan in scans)


def test_a_second_host_is_turned_away_until_the_first_has_gone(server):
    with Host(server.port) as first:
        first.say(b"QT\n")
        first.expect(b"QT\n00P\n\n")
        with Host(server.port) as second:
            assert second.line.recv(10) == b""
        first.say(b"QT\n")
        first.expect(b"QT\n00P\n\n")
    for _ in range(5):  # at once after the one before
        with Host(server.port) as next_one:
            next_one.say(b"QT\n")
            next_one.expect(b"QT\n00P\n\n")


def test_a_host_that_goes_without_a_word_leaves_a_sensor_at_rest(server):
    with Host(server.port) as host:
        host.say(b"TM0\n")
        host.expect(b"TM0\n00P\n\n")
    with Host(server.port) as host:
        host.say(b"MD0000018001000\n")
        host.scans(1)
    wait_until_free(server)
    with Host(server.port) as host:
        host.say(b"%ST\n")
        host.expect(b"%ST\n00P\n000@\n\n")


def test_a_host_that_does_not_read_misses_scans_and_gets_whole_ones(room, spec):
    plant = Plant(room, spec, START)
    serving = ScipServer(plant)
    serving.start()
    with Host(serving.port) as host:
        host.line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        host.say(b"MD0000018001000\n")
        time.sleep(0.3)
        assert len({len(scan) for scan in host.scans(3)}) == 1
        assert host.decoder.broken == 0
    serving.close()


def test_a_port_that_is_taken_is_told_with_the_remedy(room, spec, server):
    with pytest.raises(DeviceError, match=r"cannot listen there: .*give another port"):
        ScipServer(Plant(room, spec, START), port=server.port)


def test_a_server_may_be_closed_twice_and_without_a_start(room, spec):
    plant = Plant(room, spec, START)
    server = ScipServer(plant)
    server.close()
    server.close()
    assert plant.controllers == []


def test_the_hokuyolx_package_gets_along_with_it(server):
    hokuyolx = pytest.importorskip("hokuyolx")
    sensor = hokuyolx.HokuyoLX(addr=("127.0.0.1", server.port))
    try:
        assert (sensor.model, sensor.amax, sensor.scan_freq) == ("UST-10LX", 180, 10)
        _, single = sensor.get_dist()
        streamed = [(scan, pending) for scan, _, pending in sensor.iter_dist(3)]
        assert [pending for _, pending in streamed] == [2, 1, 0]
        assert all(np.array_equal(scan, single) for scan, _ in streamed)
        assert sensor.get_intens()[1].shape == (181, 2)
    finally:
        sensor.close()
