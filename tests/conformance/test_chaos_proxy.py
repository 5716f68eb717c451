from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Iterator

import numpy as np
import pytest

from benchmarks.chaos import ChaosProxy, proxied


class Echo:
    """A device that says everything back."""

    def __init__(self) -> None:
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self) -> None:
        while True:
            try:
                line, _ = self.listener.accept()
            except OSError:
                return
            with line:
                while data := line.recv(4096):
                    line.sendall(data)

    def close(self) -> None:
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()
        self.thread.join()


@pytest.fixture
def proxy() -> Iterator[ChaosProxy]:
    echo = Echo()
    with proxied(echo.listener.getsockname()) as proxy:
        yield proxy
    echo.close()


@pytest.fixture
def driver(proxy: ChaosProxy) -> Iterator[socket.socket]:
    with connect(proxy) as line:
        yield line


def connect(proxy: ChaosProxy) -> socket.socket:
    return socket.create_connection(("127.0.0.1", proxy.port), timeout=10)


def receive(line: socket.socket, count: int) -> bytes:
    data = b""
    while len(data) < count:
        more = line.recv(count - len(data))
        assert more, "the line was closed"
        data += more
    return data


def hears_nothing(line: socket.socket) -> bool:
    line.settimeout(0.1)
    try:
        return line.recv(1) is None
    except TimeoutError:
        return True
    finally:
        line.settimeout(10)


def test_without_a_fault_everything_passes_and_is_counted(proxy: ChaosProxy, driver: socket.socket) -> None:
    data = bytes(range(256)) * 100
    driver.sendall(data)
    assert receive(driver, len(data)) == data
    assert (proxy.counters.to_device, proxy.counters.to_driver) == (len(data), len(data))


def test_the_tap_hears_what_reaches_the_device(proxy: ChaosProxy, driver: socket.socket) -> None:
    heard: list[bytes] = []
    proxy.tap = lambda stamp, number, data: heard.append(data)
    driver.sendall(b"go")
    assert receive(driver, 2) == b"".join(heard) == b"go"


def test_a_cut_line_is_closed_and_refused_until_mended(proxy: ChaosProxy, driver: socket.socket) -> None:
    driver.sendall(b"a")
    receive(driver, 1)
    proxy.cut()
    with pytest.raises(OSError, match="refused"):
        connect(proxy)
    with contextlib.suppress(ConnectionResetError):  # which of the two depends on what was under way
        assert driver.recv(1) == b""
    proxy.mend()
    with connect(proxy) as again:
        again.sendall(b"back")
        assert receive(again, 4) == b"back"


def test_a_held_line_delivers_later(proxy: ChaosProxy, driver: socket.socket) -> None:
    proxy.hold()
    driver.sendall(b"late")
    assert hears_nothing(driver)
    proxy.mend()
    assert receive(driver, 4) == b"late"


def test_a_muted_device_hears_but_is_not_heard(proxy: ChaosProxy, driver: socket.socket) -> None:
    heard: list[bytes] = []
    proxy.tap = lambda stamp, number, data: heard.append(data)
    proxy.mute()
    driver.sendall(b"there?")
    assert hears_nothing(driver)
    assert heard == [b"there?"]
    proxy.mend()
    driver.sendall(b"and now")
    assert receive(driver, 7) == b"and now"


def test_a_disturbed_line_changes_about_that_share_of_the_bytes(proxy: ChaosProxy, driver: socket.socket) -> None:
    proxy.corrupt(0.01, np.random.default_rng(3))
    data = bytes(10_000)
    driver.sendall(data)
    wrong = sum(byte != 0 for byte in receive(driver, len(data)))
    assert 120 < wrong < 280  # once each way
    assert proxy.counters.corrupted >= wrong


def test_a_line_whose_device_is_gone_is_closed() -> None:
    with socket.create_server(("127.0.0.1", 0)) as nobody:
        target = nobody.getsockname()
    with proxied(target) as proxy, connect(proxy) as line:
        assert line.recv(1) == b""
