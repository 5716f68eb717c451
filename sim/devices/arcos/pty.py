"""ARCOS over a serial line, played by a pseudo-terminal."""

from __future__ import annotations

import contextlib
import os
import select
import threading
import tty

from sim.devices.arcos.firmware import Firmware
from sim.devices.arcos.handshake import Phase
from sim.devices.arcos.model import P3AT, PioneerModel
from sim.devices.arcos.session import Session
from sim.devices.plant import Plant

_CHUNK = 4096
_LOOK = 0.05  # how often it is looked whether somebody has opened the line [s]


class ArcosPty:
    """A serial port of the robot. Its speed means nothing: all that HOSTBAUD could choose are understood.

    A client that goes away without CLOSE leaves the robot connected, as on a real line: the watchdog stops it. When
    the port is opened anew and SYNC0 comes first, the robot begins anew.
    """

    def __init__(
        self,
        plant: Plant,
        *,
        watchdog: float = 1.0,
        model: PioneerModel = P3AT,
        firmware: Firmware | None = None,
    ) -> None:
        """Make the port; clients are served from `start` on.

        Args:
            plant: The robot's body.
            watchdog: Silence of a client after which the robot stops [s]; 0 = never.
            model: What kind of Pioneer it is.
            firmware: That of another line to the same robot; watchdog and model are its own then.
        """
        self.firmware = firmware or Firmware(plant, model, watchdog=watchdog)
        self.present = False
        """Whether a client has the port open."""
        self._fd, client = os.openpty()
        self.path = os.ttyname(client)
        """What a client opens: ``/dev/pts/…``."""
        tty.setraw(client)
        os.close(client)
        os.set_blocking(self._fd, False)
        self._session, self._is_new_client = Session(self.firmware), False
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="arcos-pty", daemon=True)

    def start(self) -> None:
        """Serve clients."""
        self._thread.start()

    def close(self) -> None:
        """End the connection and remove the port; may be called twice."""
        if self._closing.is_set():
            return
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join()
        self.firmware.release(self)
        os.close(self._fd)

    def _run(self) -> None:
        poll = select.poll()
        poll.register(self._fd, select.POLLIN)
        while not self._closing.is_set():
            events = poll.poll(min(self._session.wait, _LOOK) * 1000)
            happened = events[0][1] if events else 0
            if happened & select.POLLIN:
                self._serve(os.read(self._fd, _CHUNK))
            elif happened & select.POLLHUP:
                self.present = False
                self._closing.wait(_LOOK)
            else:
                self._serve(b"")

    def _serve(self, data: bytes) -> None:
        if not self.present:
            self.present = self._is_new_client = True
            self._session = Session(self.firmware)
        payloads = self._session.payloads(data)
        if payloads:
            if self._is_new_client and payloads[0] == b"\0":
                self.firmware.release(self)
            self._is_new_client = False
            self._converse(payloads)
        if self.firmware.is_held_by(self):
            self._send(self._session.report())

    def _converse(self, payloads: list[bytes]) -> None:
        if not self.firmware.claim(self):
            return
        self._send(self._session.take(payloads).packets)
        if self.firmware.phase is Phase.SYNC0:
            self.firmware.release(self)

    def _send(self, packets: bytes) -> None:
        """Send; what the client does not take in time, or is not there to take, is lost, as on a serial line."""
        with contextlib.suppress(OSError):
            os.write(self._fd, packets)
