"""An auxiliary serial port of the robot, to which something else may be wired."""

from __future__ import annotations

from collections.abc import Callable

from drivers.pioneer.codec import AuxData, encode_aux

_LARGEST = 190  # bytes of a packet
_MEMORY = 1024  # bytes that wait for GETAUX


class AuxPort:
    """Passes bytes between the client and a device on the port."""

    def __init__(self, number: int) -> None:
        """Leave the port open: nothing is wired to it."""
        self.baud = 0
        """Code of the speed."""
        self.write: Callable[[bytes], None] = lambda data: None
        """Takes what the client sends (TTY2); whoever plays the device sets it."""
        self._number, self._arrived, self._wanted = number, b"", 0

    def arrive(self, data: bytes) -> None:
        """Take bytes from the device; the oldest are lost if nobody asks for them."""
        self._arrived = (self._arrived + data)[-_MEMORY:]

    def ask(self, count: int) -> None:
        """Ask for so many bytes (GETAUX); with 0 forget what has arrived."""
        self._wanted = max(count, 0)
        if count == 0:
            self._arrived = b""

    def answer(self) -> bytes:
        """Return the packets of what was asked for, once it is there."""
        if not 0 < self._wanted <= len(self._arrived):
            return b""
        data, self._arrived = self._arrived[: self._wanted], self._arrived[self._wanted :]
        self._wanted = 0
        pieces = (data[first : first + _LARGEST] for first in range(0, len(data), _LARGEST))
        return b"".join(encode_aux(AuxData(self._number, piece)) for piece in pieces)
