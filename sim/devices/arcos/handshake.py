"""How a connection begins: three synchronising packets in order, then the client opens the servers."""

from __future__ import annotations

from enum import Enum, auto

from drivers.pioneer.codec import CommandNumber, Identity, encode_identity, encode_sync, sync_number


class Phase(Enum):
    """What a robot waits for."""

    SYNC0 = auto()
    SYNC1 = auto()
    SYNC2 = auto()
    OPEN = auto()
    """Connected, and silent until the client sends OPEN."""
    CLOSE = auto()
    """Connected, and reporting."""


_EXPECTED = {Phase.SYNC0: 0, Phase.SYNC1: 1, Phase.SYNC2: 2}
_NEXT = {0: Phase.SYNC1, 1: Phase.SYNC2, 2: Phase.OPEN}


class Handshake:
    """Follows the phases. The numbers 0, 1 and 2 are SYNCs until it is finished, and commands afterwards."""

    def __init__(self, identity: Identity) -> None:
        """Wait for SYNC0."""
        self.phase = Phase.SYNC0
        self._identity = identity

    @property
    def finished(self) -> bool:
        """Whether packets are commands by now."""
        return self.phase in (Phase.OPEN, Phase.CLOSE)

    def answer(self, payload: bytes) -> bytes:
        """Take a packet during the handshake and return the reply, empty if there is none.

        Only a payload of one byte is a SYNC. One out of order is not answered, and the robot waits for SYNC0 again;
        but SYNC0 may come at any time. OPEN and others with an argument change nothing; CLOSE begins anew.
        """
        number = sync_number(payload)
        if number is None:
            if payload[0] == CommandNumber.CLOSE:
                self.phase = Phase.SYNC0
            return b""
        if number not in (0, _EXPECTED[self.phase]):
            self.phase = Phase.SYNC0
            return b""
        self.phase = _NEXT[number]
        return encode_identity(self._identity) if number == 2 else encode_sync(number)
