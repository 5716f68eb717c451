"""Packets on the line, in both directions: header, length, payload, checksum."""

from __future__ import annotations

from struct import Struct

HEADER = b"\xfa\xfb"
MAX_PACKET = 200
"""Longest packet on the line, header and checksum included [bytes]."""
MAX_PAYLOAD = MAX_PACKET - 5
_SHORTEST, _LONGEST = 3, MAX_PACKET - 3  # of what the length byte may say
_PAIRS = tuple(Struct(f">{pairs}H") for pairs in range(128))


def checksum(payload: bytes) -> int:
    """Return the 16-bit checksum: the sum of big-endian pairs; an odd last byte is XORed into the low byte."""
    pairs, odd = divmod(len(payload), 2)
    total: int = sum(_PAIRS[pairs].unpack_from(payload)) & 0xFFFF
    return total ^ payload[-1] if odd else total


def encode(payload: bytes) -> bytes:
    """Return the packet around a payload.

    Raises:
        ValueError: The payload is empty, or longer than 195 bytes.
    """
    if not 1 <= len(payload) <= MAX_PAYLOAD:
        raise ValueError(f"a payload of {len(payload)} bytes does not fit a packet (1 to {MAX_PAYLOAD})")
    return HEADER + bytes((len(payload) + 2,)) + payload + checksum(payload).to_bytes(2, "big")


class PacketDecoder:
    """Finds the payloads of valid packets in a stream of bytes, however it is cut into pieces.

    Noise before a header is skipped. After a bad checksum or an impossible length the search goes on at the byte
    after the false header, so that no valid packet behind it is lost. It remembers less than one packet.
    """

    def __init__(self) -> None:
        self.checksum_errors = 0
        """Packets with a wrong checksum so far; false headers within noise count too."""
        self.skipped = 0
        """Bytes so far that belonged to no valid packet."""
        self._rest = b""

    @property
    def pending(self) -> int:
        """Bytes of an incomplete packet that wait for more."""
        return len(self._rest)

    def feed(self, data: bytes) -> list[bytes]:
        """Take what has arrived and return the payloads that are now complete, in order."""
        buffer = self._rest + data
        found: list[bytes] = []
        at = 0
        while (start := buffer.find(HEADER, at)) >= 0 and start + 3 <= len(buffer):
            length = buffer[start + 2]
            end = start + 3 + length
            self.skipped += start - at
            at = start
            if not _SHORTEST <= length <= _LONGEST:
                at, self.skipped = start + 1, self.skipped + 1
            elif end > len(buffer):
                break
            elif checksum(payload := buffer[start + 3 : end - 2]) == buffer[end - 2] << 8 | buffer[end - 1]:
                found.append(payload)
                at = end
            else:
                at, self.skipped = start + 1, self.skipped + 1
                self.checksum_errors += 1
        self._keep(buffer, at, start)
        return found

    def expire(self) -> list[bytes]:
        """Give up the incomplete packet, after a silence of 100 ms, and return the valid ones inside it.

        A false header, or a corrupted length, can have swallowed them.
        """
        found: list[bytes] = []
        while self._rest:
            self.skipped += 1
            rest, self._rest = self._rest[1:], b""
            found += self.feed(rest)
        return found

    def _keep(self, buffer: bytes, at: int, start: int) -> None:
        """Remember the beginning of a packet at ``start``, or a last byte that may become a header."""
        if start < 0:
            start = len(buffer) - (buffer.endswith(HEADER[:1]) and len(buffer) > at)
        self.skipped += start - at
        self._rest = buffer[start:]
