from __future__ import annotations

import contextlib
import os
import pty
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from drivers.link import Link
from zavis_bt.errors import DeviceError

NOBODY = 65534  # Linux's user without rights


@pytest.fixture
def server() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        yield listening


def address(server: socket.socket) -> str:
    return f"tcp://127.0.0.1:{server.getsockname()[1]}"


def test_bytes_go_both_ways_over_tcp(server):
    link = Link(address(server), baud=9600, where="here")
    peer, _ = server.accept()
    with peer:
        link.write(b"ping")
        assert peer.recv(16) == b"ping"
        peer.sendall(b"pong")
        assert link.read(timeout=5.0) == b"pong"
        link.close()
        link.close()


def test_bytes_go_both_ways_over_a_serial_port():
    master, slave = pty.openpty()
    link = Link(os.ttyname(slave), baud=9600, where="here")
    link.write(b"ping")
    assert os.read(master, 16) == b"ping"
    os.write(master, b"pong")
    assert link.read(timeout=5.0) == b"pong"
    link.set_baud(38400)
    link.close()
    for descriptor in (master, slave):
        os.close(descriptor)


def test_reading_returns_nothing_when_nothing_comes(server):
    link = Link(address(server), baud=9600, where="here")
    peer, _ = server.accept()
    with peer:
        assert link.read(timeout=0.01) == b""
        link.close()


def test_small_packets_are_not_held_back(server):
    link = Link(address(server), baud=9600, where="here")
    peer, _ = server.accept()
    with peer, socket.socket(fileno=os.dup(link._serial.fileno())) as line:
        assert line.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
        link.close()


def test_the_end_of_the_connection_is_told(server):
    link = Link(address(server), baud=9600, where="robot.yaml: devices.base")
    peer, _ = server.accept()
    peer.close()
    with pytest.raises(DeviceError, match=r"robot\.yaml: devices\.base: tcp://.*: the other end has closed"):
        link.read(timeout=5.0)
    link.close()


def test_a_line_that_takes_nothing_is_given_up(server):
    link = Link(address(server), baud=9600, where="here")
    peer, _ = server.accept()
    done = threading.Event()

    def flood() -> None:
        with contextlib.suppress(DeviceError):
            while True:
                link.write(bytes(100_000))
        done.set()

    thread = threading.Thread(target=flood, daemon=True)
    thread.start()
    assert done.wait(20.0)
    thread.join()
    peer.close()
    link.close()


@pytest.mark.parametrize(
    ("port", "says"),
    [
        ("tcp://127.0.0.1:1", "nothing listens there"),
        ("/dev/no-such-port", "there is no such port"),
        ("/dev/null", "is not a serial port"),
        ("tcp://no-such-host.invalid:8101", "no such host"),
        ("tcp://127.0.0.1", ""),
        ("tcp://127.0.0.1:many", ""),
        ("warp://7", ""),
    ],
)
def test_a_port_that_cannot_be_opened_is_told_in_one_line(port, says):
    with pytest.raises(DeviceError) as caught:
        Link(port, baud=9600, where="robot.yaml: devices.base")
    line = str(caught.value)
    assert line.startswith(f"robot.yaml: devices.base: {port}: ")
    assert says in line
    assert "\n" not in line


@contextmanager
def nobody_special() -> Iterator[None]:
    """Be a user who may not open everything, should the tests run as root."""
    before = os.geteuid()
    os.seteuid(before or NOBODY)
    try:
        yield
    finally:
        os.seteuid(before)


def test_a_port_one_may_not_open_names_the_group_to_join(tmp_path):
    port = tmp_path / "port"
    port.touch(mode=0)
    with nobody_special(), pytest.raises(DeviceError, match=r"permission denied .*dialout"):
        Link(str(port), baud=9600, where="here")
