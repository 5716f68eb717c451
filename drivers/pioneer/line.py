"""The line to the robot in packets: what every part of the driver reads from and writes to."""

from __future__ import annotations

import time
from collections import deque

from drivers.link import Link
from drivers.pioneer.codec import PacketDecoder

_STALE = 0.1  # silence after which the rest of a packet is not waited for any more [s]
_SAMPLE = 64


class PacketLine:
    """Packets over a `Link`. One thread reads, one at a time writes."""

    def __init__(self, link: Link) -> None:
        """Take over an open link."""
        self.link = link
        self.decoder = PacketDecoder()
        self.sample = b""
        """The first bytes that came, to be judged if no packet does."""
        self._waiting: deque[bytes] = deque()
        self._heard = time.monotonic()

    def read(self, timeout: float) -> list[bytes]:
        """Return the payloads that have arrived; none if nothing comes within ``timeout`` [s].

        Raises:
            DeviceError: The line is broken, or the other end has closed it.
        """
        if self._waiting:
            taken = list(self._waiting)
            self._waiting.clear()
            return taken
        data = self.link.read(timeout)
        now = time.monotonic()
        if data:
            self._heard = now
            self.sample = (self.sample + data[:_SAMPLE])[:_SAMPLE]
            return self.decoder.feed(data)
        if self.decoder.pending and now - self._heard > _STALE:
            return self.decoder.expire()
        return []

    def read_one(self, timeout: float) -> bytes | None:
        """Return the next payload, or None if there is none within ``timeout`` [s].

        Raises:
            DeviceError: The line is broken, or the other end has closed it.
        """
        deadline = time.monotonic() + timeout
        while not self._waiting:
            left = deadline - time.monotonic()
            if left <= 0:
                return None
            self._waiting.extend(self.read(min(left, _STALE)))
        return self._waiting.popleft()

    def write(self, packets: bytes) -> None:
        """Send packets.

        Raises:
            DeviceError: The line is broken, or takes nothing.
        """
        self.link.write(packets)

    def drain(self, seconds: float) -> None:
        """Throw away what arrives in the next ``seconds`` [s].

        Raises:
            DeviceError: The line is broken, or the other end has closed it.
        """
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            self.read(left)
        self._waiting.clear()
