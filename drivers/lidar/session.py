"""A conversation with a sensor: requests, answers, and what came instead of them."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable

from drivers.lidar.codec import Answer, AnswerDecoder, Request
from drivers.link import Link
from zavis_bt.errors import DeviceError

_READ = 0.05  # [s]
_HEARD = 24  # bytes of an unknown device's answer that are shown


class Session:
    """One open line to a sensor. Used by one thread at a time."""

    def __init__(self, port: str, baud: int, where: str, cancelled: Callable[[], bool]) -> None:
        """Open the line.

        Args:
            port: As in the settings.
            baud: Speed of a serial port.
            where: Place in the robot file, to begin error messages with.
            cancelled: Whether to give up; asked while waiting.

        Raises:
            DeviceError: It cannot be opened.
        """
        self.place = f"{where}: {port}"
        self.link = Link(port, baud=baud, where=where)
        self.decoder = AnswerDecoder()
        self._cancelled = cancelled
        self._heard = b""

    def ask(self, request: Request, *, timeout: float = 0.5, tries: int = 2) -> Answer:
        """Return the answer to a request, whatever its status; other answers that come in between are left out.

        Raises:
            DeviceError: There is none within ``timeout`` [s], however often it is tried, or the line is broken.
        """
        answer = self.try_to_ask(request, timeout=timeout, tries=tries)
        if answer is None:
            raise DeviceError(self.silence(request))
        return answer

    def try_to_ask(self, request: Request, *, timeout: float = 0.5, tries: int = 2) -> Answer | None:
        """Return the answer to a request, or None without one.

        Raises:
            DeviceError: The line is broken.
        """
        for _ in range(tries):
            self.link.write(request.line + b"\n")
            deadline = time.monotonic() + timeout
            while (left := deadline - time.monotonic()) > 0:
                for answer in self.receive(min(left, _READ)):
                    if answer.echo == request.line and answer.status != "99":
                        return answer
        return None

    def receive(self, timeout: float) -> list[Answer]:
        """Return the answers that are complete now, after waiting up to ``timeout`` [s] for bytes.

        Raises:
            DeviceError: The line is broken, or the conversation was given up.
        """
        if self._cancelled():
            raise DeviceError(f"{self.place}: closed")
        data = self.link.read(timeout)
        if len(self._heard) < _HEARD:
            self._heard += data[: _HEARD - len(self._heard)]
        return self.decoder.feed(data)

    def drain(self, quiet: float, longest: float) -> None:
        """Throw away what comes until nothing does for ``quiet`` [s], or for ``longest`` [s].

        Raises:
            DeviceError: The line is broken.
        """
        deadline = time.monotonic() + longest
        while time.monotonic() < deadline and self.link.read(quiet):
            pass

    def close(self) -> None:
        """Switch the laser off, if the sensor still hears it, and close the line; never raises."""
        self._cancelled = lambda: False
        with contextlib.suppress(DeviceError):
            self.try_to_ask(Request("QT"), timeout=0.2, tries=1)
        self.link.close()

    def silence(self, request: Request) -> str:
        """Return what to tell when nobody answers a request: what came instead, and the remedy."""
        if not self._heard:
            hint = "is it the LiDAR's port, and no other program connected to it?"
            return f"{self.place}: does not answer ({hint if self.link.is_tcp else 'is it the right port, and baud?'})"
        if self.decoder.answers:
            return f"{self.place}: no answer to {request.line.decode('ascii')} (is the cable sound?)"
        hint = "is it the LiDAR's port?" if self.link.is_tcp else "is it the LiDAR's port, and is 'baud' right?"
        return f"{self.place}: answers, but not in SCIP 2.0: {_shown(self._heard)} ({hint})"


def _shown(data: bytes) -> str:
    """Return bytes as text if they are, else in hexadecimal."""
    text = data.decode("latin-1")
    if all(character.isprintable() or character in "\r\n\t" for character in text) and text.isascii():
        return repr(text)
    return data.hex(" ")
