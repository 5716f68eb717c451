from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest
from arcos_bench import CENTRE, HALL, PIONEER, TcpClient, broken, drive, wait_for

from drivers.pioneer.codec import (
    CommandNumber,
    Flags,
    PacketType,
    decode_config,
    decode_identity,
    encode_command,
    encode_sync,
    is_sip,
)
from sim.devices.arcos import ArcosServer, Phase
from sim.devices.plant import Plant
from zavis_bt.errors import DeviceError

C = CommandNumber


@pytest.fixture
def plant() -> Iterator[Plant]:
    plant = Plant(HALL, PIONEER, CENTRE)
    plant.start()
    yield plant
    plant.close()


@pytest.fixture
def server(plant: Plant) -> Iterator[ArcosServer]:
    server = ArcosServer(plant, port=0, watchdog=1.0)
    server.start()
    yield server
    server.close()


@pytest.fixture
def client(server: ArcosServer) -> Iterator[TcpClient]:
    with TcpClient(server.port) as client:
        yield client


def test_a_client_connects_drives_and_closes(client: TcpClient, plant: Plant) -> None:
    replies = client.synchronise()
    assert replies[:2] == [b"\0", b"\1"]
    assert decode_identity(replies[2]) == ("simrobot", "Pioneer", "p3at-sh")
    client.send(C.OPEN)
    first = client.sip()
    assert (first.x, first.y, first.heading) == (0, 0, 0)
    drive(client)
    assert client.sip(lambda sip: sip.x > 100).moving
    client.send(C.VEL, 0)
    client.sip(lambda sip: not sip.moving)
    client.send(C.CLOSE)
    with pytest.raises(EOFError):
        for _ in client.packets():
            pass


def test_the_connection_that_aria_makes_is_understood(client: TcpClient) -> None:
    """The order of packets that its client was seen to send, with their bytes."""
    sent = {
        "sync0": "FA FB 03 00 00 00",
        "sync1": "FA FB 03 01 00 01",
        "sync2": "FA FB 03 02 00 02",
        "open": "FA FB 06 01 3B 01 00 02 3B",
        "config": "FA FB 06 12 3B 01 00 13 3B",
        "enable": "FA FB 06 04 3B 01 00 05 3B",
        "vel": "FA FB 06 0B 3B FA 00 05 3B",
        "rvel": "FA FB 06 15 1B 0A 00 1F 1B",
        "close": "FA FB 06 02 3B 01 00 03 3B",
    }
    packets = {name: bytes.fromhex(text) for name, text in sent.items()}
    for name in ("sync0", "sync1", "sync2"):
        client.write(packets[name])
        assert client.next()[0] == packets[name][3]
    client.write(packets["open"] + packets["config"])
    config = next(decode_config(payload) for payload in client.packets() if payload[0] == PacketType.CONFIG)
    client.send(C.BATTERYINFO, 1)
    client.write(packets["enable"])
    limits = (
        (C.SETV, config.velocity_max),
        (C.SETA, config.acceleration),
        (C.SETA, -config.deceleration),
        (C.SETRV, config.rotation_velocity_max),
        (C.SETRA, config.rotation_acceleration),
        (C.SETRA, -config.rotation_deceleration),
    )
    for number, value in limits:
        client.send(number, value)
    client.write(packets["vel"] + packets["rvel"])
    sip = client.sip(lambda sip: sip.left_velocity + sip.right_velocity == 500)
    assert sip.flags & Flags.MOTORS_ENABLED
    assert sip.rotational_velocity == -100
    client.send(C.VEL, 0)
    client.send(C.RVEL, 0)
    client.send(C.ENABLE, 0)
    client.sip(lambda sip: not sip.moving and not sip.flags & Flags.MOTORS_ENABLED)
    client.write(packets["close"])
    with pytest.raises(EOFError):
        for _ in client.packets():
            pass


def test_open_with_an_argument_does_not_disturb_the_handshake(client: TcpClient) -> None:
    client.send(C.OPEN, 1)
    client.write(encode_sync(0))
    assert client.next() == b"\0"
    client.send(C.OPEN, 1)
    client.write(encode_sync(1))
    assert client.next() == b"\1"
    client.send(C.CLOSE, 1)
    client.connect()


def test_packets_may_come_in_pieces_together_and_between_noise(client: TcpClient) -> None:
    stream = b"WMS2\r\xfa" + encode_sync(0) + b"\xfa\xfb\x03junk" + encode_sync(1) + b"\x00\xfa\xfa"
    stream += encode_sync(2)[1:] + encode_command(C.OPEN, 1)
    for at in range(0, len(stream), 3):
        client.write(stream[at : at + 3])
    kinds = [client.next()[0] for _ in range(4)]
    assert kinds[:3] == [0, 1, 2]
    assert kinds[3] in (PacketType.STANDING, PacketType.MOVING)


def test_a_false_header_does_not_swallow_what_follows_for_ever(client: TcpClient) -> None:
    client.write(b"\xfa\xfb\xc0" + encode_sync(0))
    assert client.next() == b"\0"


def test_packets_with_a_wrong_checksum_neither_move_nor_feed_the_watchdog(client: TcpClient, plant: Plant) -> None:
    client.connect()
    drive(client, 500)
    count = 0
    for payload in client.packets():
        client.write(broken(encode_command(C.VEL, 700)) + broken(encode_command(C.PULSE)))
        count += is_sip(payload)
        if plant.motion.linear == 0.0:
            break
    assert count > 5
    assert client.sip().flags & Flags.MOTORS_ENABLED


def test_a_client_that_disappears_stops_the_robot_at_once(server: ArcosServer, plant: Plant) -> None:
    with TcpClient(server.port) as client:
        client.connect()
        drive(client)
        here = plant.motion.true.x
    wait_for(lambda: server.firmware.phase is Phase.SYNC0 and plant.motion.linear == 0.0)
    assert plant.motion.true.x - here < 0.5
    assert not server.firmware.controller.motors


def test_a_connection_that_is_reset_counts_as_closed(server: ArcosServer, plant: Plant) -> None:
    with TcpClient(server.port) as client:
        client.connect()
        drive(client)
        client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
    wait_for(lambda: server.firmware.phase is Phase.SYNC0 and plant.motion.linear == 0.0)
    with TcpClient(server.port) as client:
        client.connect()


def test_a_second_client_is_refused_until_the_first_has_gone(server: ArcosServer, client: TcpClient) -> None:
    client.connect()
    with pytest.raises(ConnectionError), TcpClient(server.port) as second:
        second.connect()
    client.sip()
    client.send(C.CLOSE, 1)
    wait_for(lambda: server.firmware.phase is Phase.SYNC0)
    reconnect(server)


def reconnect(server: ArcosServer) -> None:
    """The port may still be on its way from the old client to the new one."""

    def attempt() -> bool:
        try:
            with TcpClient(server.port) as client:
                client.connect()
        except (ConnectionError, EOFError):
            return False
        return True

    wait_for(attempt)


def test_clients_may_come_and_go(server: ArcosServer) -> None:
    for _ in range(5):
        reconnect(server)


def test_reports_come_at_a_steady_pace_and_never_when_silent(client: TcpClient) -> None:
    client.synchronise()
    assert client.quiet(0.25)
    client.send(C.OPEN, 1)
    for _ in range(5):
        client.sip()


def test_a_port_that_is_taken_is_said_in_one_line(server: ArcosServer, plant: Plant) -> None:
    with pytest.raises(DeviceError, match=rf"127.0.0.1:{server.port}: cannot be listened at \(another program"):
        ArcosServer(plant, port=server.port)


def test_closing_the_server_ends_the_connection(server: ArcosServer, client: TcpClient) -> None:
    client.connect()
    server.close()
    server.close()
    with pytest.raises((EOFError, ConnectionError)):
        for _ in client.packets():
            pass
