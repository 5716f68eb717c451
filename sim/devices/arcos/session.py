"""What all lines share: bytes to packets, packets to the firmware, and reports on time."""

from __future__ import annotations

import time

from drivers.pioneer.codec import PacketDecoder
from sim.devices.arcos.firmware import Firmware, Reply

_SILENCE = 0.1  # after which an incomplete packet is given up [s]


class Session:
    """One client at the other end of a line."""

    def __init__(self, firmware: Firmware) -> None:
        """Begin with an empty decoder; the first report is due one period from now."""
        self._firmware, self._decoder = firmware, PacketDecoder()
        self._period = firmware.model.period
        self._due = time.monotonic() + self._period
        self._heard = time.monotonic()

    def payloads(self, data: bytes) -> list[bytes]:
        """Return the packets that are complete with these bytes; call it with none when nothing came in time."""
        now = time.monotonic()
        if data:
            self._heard = now
            return self._decoder.feed(data)
        if self._decoder.pending and now - self._heard > _SILENCE:
            return self._decoder.expire()
        return []

    def take(self, payloads: list[bytes]) -> Reply:
        """Hand packets to the firmware; those behind the end of the connection are dropped."""
        replies = b""
        for payload in payloads:
            reply = self._firmware.receive(payload)
            replies += reply.packets
            if reply.closed:
                return Reply(replies, True)
        return Reply(replies)

    @property
    def wait(self) -> float:
        """Time until the next report is due [s]."""
        return max(self._due - time.monotonic(), 0.0)

    def report(self) -> bytes:
        """Return what the robot reports if that is due; reports that were missed are left out."""
        late = time.monotonic() - self._due
        if late < 0:
            return b""
        self._due += self._period * (1 + late // self._period)
        return self._firmware.report()
