"""A TCP line between a driver and its device that can be cut, held up, muted and disturbed."""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

_CHUNK = 65536
_POLL = 0.05  # [s]

Tap = Callable[[float, int, bytes], None]


@dataclass
class Counters:
    """What has gone through a line, in bytes."""

    to_device: int = 0
    to_driver: int = 0
    dropped: int = 0
    corrupted: int = 0
    connections: int = 0


@dataclass
class _Pair:
    driver: socket.socket
    device: socket.socket
    number: int

    def close(self) -> None:
        for end in (self.driver, self.device):
            end.close()


class ChaosProxy:
    """Passes bytes between drivers that connect to ``port`` and a device at ``target``, with the faults one orders.

    One thread does all of it. A fault lasts until `mend` or the next fault.
    """

    def __init__(self, target: tuple[str, int]) -> None:
        """Listen on any free port of this machine; nothing passes until `start`.

        Args:
            target: Host and port of the device.
        """
        self._target = target
        self._listener: socket.socket | None = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        self.counters = Counters()
        self.tap: Tap | None = None
        """Called by the proxy's thread with `time.monotonic` [s], the connection's number, and the bytes that are about
        to be handed to the device."""
        self._pairs: list[_Pair] = []
        self._orders: list[Callable[[], None]] = []
        self._done = threading.Condition()
        self._held = self._muted = False
        self._rate = 0.0
        self._rng = np.random.default_rng(0)
        self._running = True
        self._thread = threading.Thread(target=self._run, name="chaos", daemon=True)

    # -- faults --------------------------------------------------------------------------------------------------

    def cut(self) -> None:
        """Close all connections and refuse new ones: a plug pulled from a device that notices it."""
        self._order(self._cut)

    def hold(self) -> None:
        """Let nothing through either way and keep it all for later: a dead network, on which TCP tries again."""
        self._order(lambda: self._set(held=True))

    def mute(self) -> None:
        """Throw away what the device says, and nothing else: a device that has fallen silent."""
        self._order(lambda: self._set(muted=True))

    def corrupt(self, rate: float, rng: np.random.Generator) -> None:
        """Change this share of all bytes, both ways, to other ones."""
        self._order(lambda: self._set(rate=rate, rng=rng))

    def mend(self) -> None:
        """End the fault."""
        self._order(self._set)

    # -- life ----------------------------------------------------------------------------------------------------

    def start(self) -> None:
        """Let bytes pass."""
        self._thread.start()

    def close(self) -> None:
        """Close everything; may be called twice."""
        self._running = False
        if self._thread.is_alive():
            self._thread.join()
        self._cut()

    def _order(self, act: Callable[[], None]) -> None:
        """Have the thread do it, so that a fault begins when this returns and never in the middle of a packet."""
        with self._done:
            self._orders.append(act)
            if not self._done.wait_for(lambda: act not in self._orders, timeout=5.0):
                raise TimeoutError("the proxy is stuck")

    def _set(
        self, held: bool = False, muted: bool = False, rate: float = 0.0, rng: np.random.Generator | None = None
    ) -> None:
        self._held, self._muted, self._rate, self._rng = held, muted, rate, rng or self._rng
        if self._listener is None and self._running:
            self._listener = socket.create_server(("127.0.0.1", self.port))

    def _cut(self) -> None:
        if self._listener is not None:
            self._listener.close()
            self._listener = None
        for pair in self._pairs:
            pair.close()
        self._pairs.clear()

    def _run(self) -> None:
        while self._running:
            self._obey()
            for source in self._readable():
                self._serve(source)

    def _obey(self) -> None:
        with self._done:
            for act in self._orders:
                act()
            self._orders.clear()
            self._done.notify_all()

    def _readable(self) -> list[socket.socket]:
        sources = [end for pair in self._pairs for end in (pair.driver, pair.device)]
        if self._listener is not None:
            sources.append(self._listener)
        if self._held or not sources:
            time.sleep(0.005)
            return []
        with selectors.DefaultSelector() as selector:
            for source in sources:
                selector.register(source, selectors.EVENT_READ)
            # Short, since an order must not wait for bytes.
            return [key.fileobj for key, _ in selector.select(_POLL / 5) if isinstance(key.fileobj, socket.socket)]

    def _serve(self, source: socket.socket) -> None:
        if source is self._listener:
            self._accept(source)
            return
        pair = next((pair for pair in self._pairs if source in (pair.driver, pair.device)), None)
        if pair is None:
            return
        try:
            data = source.recv(_CHUNK)
            if data:
                self._pass(pair, source, data)
                return
        except OSError:  # broken by either end, which is the same as closed
            pass
        pair.close()
        self._pairs.remove(pair)

    def _accept(self, listener: socket.socket) -> None:
        driver, _ = listener.accept()
        try:
            device = socket.create_connection(self._target, timeout=5.0)
        except OSError:
            driver.close()
            return
        for end in (driver, device):
            end.settimeout(5.0)
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.counters.connections += 1
        self._pairs.append(_Pair(driver, device, self.counters.connections))

    def _pass(self, pair: _Pair, source: socket.socket, data: bytes) -> None:
        if self._rate:
            data = self._disturbed(data)
        if source is pair.driver:
            self.counters.to_device += len(data)
            if self.tap is not None:
                self.tap(time.monotonic(), pair.number, data)
            pair.device.sendall(data)
        elif self._muted:
            self.counters.dropped += len(data)
        else:
            self.counters.to_driver += len(data)
            pair.driver.sendall(data)

    def _disturbed(self, data: bytes) -> bytes:
        values = np.frombuffer(data, dtype=np.uint8).copy()
        hit = self._rng.random(len(values)) < self._rate
        values[hit] ^= self._rng.integers(1, 256, int(hit.sum()), dtype=np.uint8)
        self.counters.corrupted += int(hit.sum())
        return values.tobytes()


@contextlib.contextmanager
def proxied(target: tuple[str, int]) -> Iterator[ChaosProxy]:
    """Open a line to a device for a while."""
    proxy = ChaosProxy(target)
    proxy.start()
    try:
        yield proxy
    finally:
        proxy.close()
