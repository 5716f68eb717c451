"""Frames and SDO transfers between this computer and the drives."""

from __future__ import annotations

import contextlib
import struct
import threading
import time
from collections.abc import Callable
from typing import Any, cast

from drivers.pan_tilt.bus import explain, open_bus
from drivers.pan_tilt.objects import HEARTBEAT, NMT, OPERATIONAL, SDO_ANSWER, SYNC
from drivers.pan_tilt.settings import PanTiltSettings
from drivers.pan_tilt.trouble import Trouble

_POLL = 0.1  # [s]
_PAUSE = 0.05  # after a failed reception [s]
_ATTEMPTS = 3
_FRAME = 8
_ALIVE = 1.0  # so long after its last sign of life the controlling thread counts as alive [s]
_MISSING = (0x0602_0000, 0x0609_0011)

Receive = Callable[[int, bytes], None]


class Line:
    """A CANopen network with this computer as its master. A thread of it hands frames on; another beats."""

    def __init__(self, settings: PanTiltSettings, receive: Receive) -> None:
        """Open the bus.

        Args:
            settings: Bus and node numbers.
            receive: Called with identifier and data of every frame of the drives but SDO answers; must be quick.

        Raises:
            Trouble: The bus cannot be opened.
        """
        bus = open_bus(settings)
        import canopen

        self._settings, self._receive, self._bus = settings, receive, bus
        self._network = canopen.Network(bus)
        self._clients = {}
        make_dictionary = cast(Any, canopen.ObjectDictionary)  # canopen gives its constructor no types
        for number in (settings.pan_node, settings.tilt_node):
            node = canopen.RemoteNode(number, make_dictionary())
            self._network.add_node(node)
            node.sdo.RESPONSE_TIMEOUT = settings.sdo_timeout
            self._clients[number] = node.sdo
        self._asked: int | None = None
        self._closed = threading.Event()
        self._sign_of_life = time.monotonic()
        self.broken = ""
        """Why the bus takes no frames; empty if it does."""
        self._threads = [
            threading.Thread(target=target, name=f"pan-tilt {target.__name__.strip('_')}", daemon=True)
            for target in (self._listen, self._beat)
        ]
        for thread in self._threads:
            thread.start()

    def send(self, identifier: int, data: bytes = b"") -> None:
        """Send a frame.

        Raises:
            Trouble: The bus does not take it.
        """
        self._sign_of_life = time.monotonic()
        self._transmit(identifier, data)

    def sync(self) -> None:
        """Send SYNC.

        Raises:
            Trouble: The bus does not take it.
        """
        self.send(SYNC)

    def command(self, node: int, command: int) -> None:
        """Send an NMT command.

        Raises:
            Trouble: The bus does not take it.
        """
        self.send(NMT, bytes([command, node]))

    def beat(self) -> None:
        """Send this computer's heartbeat out of turn: a drive begins to watch with the first that it hears.

        Raises:
            Trouble: The bus does not take it.
        """
        self.send(HEARTBEAT + self._settings.master_node, bytes([OPERATIONAL]))

    def read(self, node: int, index: int, sub: int = 0) -> bytes | None:
        """Return an object of a drive, or None if the drive lacks it.

        Raises:
            Trouble: The drive does not answer, or refuses.
        """
        client = self._clients[node]
        return self._transfer(node, index, sub, lambda: bytes(client.upload(index, sub)))

    def write(self, node: int, index: int, sub: int, data: bytes) -> bool:
        """Set an object of a drive; return whether the drive has it.

        Raises:
            Trouble: The drive does not answer, or refuses.
        """
        client = self._clients[node]

        def download() -> bytes:
            client.download(index, sub, data)
            return data

        return self._transfer(node, index, sub, download) is not None

    def close(self) -> None:
        """Leave the bus; never raises, may be called twice."""
        self._closed.set()
        for thread in self._threads:
            if thread is not threading.current_thread():
                thread.join()
        self._bus.shutdown()

    def _transmit(self, identifier: int, data: bytes) -> None:
        import can

        try:
            self._network.send_message(identifier, data)
        except (can.CanError, OSError, ValueError) as error:  # ValueError: a closed serial adapter
            self.broken = explain(error, self._settings)
            raise Trouble(self.broken) from error

    def _transfer(self, node: int, index: int, sub: int, work: Callable[[], bytes]) -> bytes | None:
        from canopen import SdoAbortedError
        from canopen.sdo.exceptions import SdoError

        self._asked = node
        try:
            for _ in range(_ATTEMPTS):
                self._sign_of_life = time.monotonic()
                try:
                    return work()
                except SdoAbortedError as abort:
                    if abort.code in _MISSING:
                        return None
                    raise Trouble(f"refuses object {index:04X}:{sub:X} ({abort})") from abort
                except (SdoError, RuntimeError, ValueError, struct.error):  # no answer, or one that makes no sense
                    if self._closed.is_set():
                        break
        finally:
            self._asked = None
        raise Trouble("does not answer")

    def _listen(self) -> None:
        import can

        while not self._closed.is_set():
            try:
                message = self._bus.recv(_POLL)
            except (can.CanError, OSError, ValueError) as error:  # no CAN frame, or the bus is down
                if isinstance(error, OSError) or isinstance(error.__cause__, OSError):
                    self.broken = explain(error, self._settings)
                time.sleep(_PAUSE)
                continue
            if message is not None and not (message.is_error_frame or message.is_remote_frame):
                self._hand_on(message.arbitration_id, bytes(message.data), message.timestamp)

    def _hand_on(self, identifier: int, data: bytes, timestamp: float) -> None:
        node = identifier - SDO_ANSWER
        if node not in self._clients:
            self._receive(identifier, data)
        elif node == self._asked and len(data) == _FRAME:
            self._network.notify(identifier, bytearray(data), timestamp)

    def _beat(self) -> None:
        """Send this computer's heartbeat for as long as the thread that controls the drives gives signs of life."""
        while not self._closed.wait(self._settings.heartbeat):
            if time.monotonic() - self._sign_of_life < _ALIVE:
                with contextlib.suppress(Trouble):
                    self._transmit(HEARTBEAT + self._settings.master_node, bytes([OPERATIONAL]))
