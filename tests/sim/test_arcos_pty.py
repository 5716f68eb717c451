from __future__ import annotations

import contextlib
import os
import tty
from collections.abc import Iterator

import pytest
from arcos_bench import CENTRE, HALL, PIONEER, Client, TcpClient, drive, wait_for

from drivers.pioneer.codec import (
    CommandNumber,
    Flags,
    encode_sync,
    is_sip,
)
from sim.devices.arcos import ArcosPty, ArcosServer, Firmware, Phase
from sim.devices.plant import Plant

C = CommandNumber


@pytest.fixture
def plant() -> Iterator[Plant]:
    plant = Plant(HALL, PIONEER, CENTRE)
    plant.start()
    yield plant
    plant.close()


@pytest.fixture
def pty(plant: Plant) -> Iterator[ArcosPty]:
    pty = ArcosPty(plant, watchdog=1.0)
    pty.start()
    yield pty
    pty.close()


@contextlib.contextmanager
def open_port(path: str) -> Iterator[Client]:
    fd = os.open(path, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(fd)
    try:
        yield Client(fd, lambda data: os.write(fd, data), lambda size: os.read(fd, size))
    finally:
        os.close(fd)


def test_a_robot_on_a_serial_line_connects_and_drives(pty: ArcosPty) -> None:
    with open_port(pty.path) as client:
        client.write(b"WMS2\r")
        client.connect()
        client.send(C.HOSTBAUD, 2)
        drive(client)
        client.send(C.CLOSE)
        wait_for(lambda: pty.firmware.phase is Phase.SYNC0)
        client.connect()


def test_on_a_serial_line_the_watchdog_stops_a_robot_whose_client_has_gone(pty: ArcosPty, plant: Plant) -> None:
    with open_port(pty.path) as client:
        client.connect()
        drive(client)
    wait_for(lambda: plant.motion.linear == 0.0)
    assert pty.firmware.phase is Phase.CLOSE
    assert pty.firmware.controller.motors


def test_on_a_serial_line_a_new_client_begins_anew(pty: ArcosPty) -> None:
    with open_port(pty.path) as client:
        client.connect()
        drive(client)
    wait_for(lambda: not pty.present)
    with open_port(pty.path) as client:
        client.connect()
        assert not client.sip().flags & Flags.MOTORS_ENABLED


def test_a_client_that_goes_on_where_another_left_off_finds_the_robot_connected(pty: ArcosPty) -> None:
    with open_port(pty.path) as client:
        client.connect()
    wait_for(lambda: not pty.present)
    with open_port(pty.path) as client:
        client.send(C.PULSE + 200)
        client.sip()
        client.write(encode_sync(0))  # a PULSE to a robot that is connected
        assert is_sip(client.next())
        client.send(C.CLOSE)
        wait_for(lambda: pty.firmware.phase is Phase.SYNC0)


def test_one_robot_on_two_lines_serves_one_client_at_a_time(plant: Plant) -> None:
    firmware = Firmware(plant)
    server, pty = ArcosServer(plant, port=0, firmware=firmware), ArcosPty(plant, firmware=firmware)
    server.start()
    pty.start()
    try:
        with open_port(pty.path) as wired:
            wired.connect()
            with pytest.raises((EOFError, ConnectionError)), TcpClient(server.port) as client:
                client.connect()
            wired.sip()
            wired.send(C.CLOSE)
            wait_for(lambda: firmware.phase is Phase.SYNC0)
            with TcpClient(server.port) as client:
                client.connect()
                wired.write(encode_sync(0))
                assert wired.quiet(0.2)
                client.sip()
            wait_for(lambda: firmware.phase is Phase.SYNC0 and firmware.claim(pty))
            wired.connect()
        wait_for(lambda: not pty.present)
        with TcpClient(server.port) as client:  # nobody is at the other end of the serial line
            client.connect()
    finally:
        server.close()
        pty.close()
