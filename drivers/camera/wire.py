"""Messages of the simulator's camera protocol: bytes to messages and back (docs/camera_protocol.md)."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any
from zlib import crc32

MAGIC = b"ZVCM"
VERSION = 1
MAX_HEADER = 1 << 20
"""Bytes of JSON in one message, at most."""
MAX_BODY = 32 << 20
"""Bytes of pixels in one message, at most."""

_FIXED = struct.Struct(">4sBBHIII")  # magic, version, kind, reserved, header's and body's length, their checksum
_CHECK = struct.Struct(">I")
PREFIX = _FIXED.size + _CHECK.size
"""Bytes before the header."""


class WireError(ValueError):
    """A message does not say what the protocol lets it say."""


class Kind(IntEnum):
    """What a message is."""

    IDENTIFY = 0x01
    NEXT = 0x02
    PIXELS = 0x03
    IDENTITY = 0x81
    FRAME = 0x82
    NOTHING_NEW = 0x83
    GONE = 0x84
    ERROR = 0xFF


@dataclass(frozen=True, slots=True)
class Message:
    """One message."""

    kind: int
    """One of `Kind`, or a number that this version does not know."""
    header: Mapping[str, Any]
    body: bytes = b""
    version: int = VERSION


def encode(message: Message) -> list[bytes]:
    """Return the message's bytes, in pieces to be sent one after the other.

    Raises:
        ValueError: It is longer than a message may be.
    """
    header = json.dumps(message.header, separators=(",", ":"), allow_nan=False).encode()
    if len(header) > MAX_HEADER or len(message.body) > MAX_BODY:
        raise ValueError(f"a message of {len(header)} + {len(message.body)} bytes (at most {MAX_HEADER} + {MAX_BODY})")
    check = crc32(message.body, crc32(header))
    fixed = _FIXED.pack(MAGIC, message.version, message.kind, 0, len(header), len(message.body), check)
    return [fixed + _CHECK.pack(crc32(fixed)) + header, message.body]


class Decoder:
    """Finds messages in a stream of bytes, whatever else is in it.

    It holds no more than one message of the greatest size and what was fed last. A message whose checksum fails is
    searched for others that may begin inside it.
    """

    def __init__(self) -> None:
        self._buffer = bytearray()
        self.dropped = 0
        """Bytes so far that belong to no message."""

    def feed(self, data: bytes) -> list[Message]:
        """Take bytes as they come; return the messages that are now complete. Never raises."""
        self._buffer += data
        messages = []
        at = 0
        while True:
            at = self._find(at)
            prefix = self._prefix(at)
            if prefix is None:
                break
            version, kind, header_end, end, check = prefix
            if end > len(self._buffer):
                break
            message = self._message(version, kind, at + PREFIX, header_end, end, check)
            if message is None:
                self.dropped += 1
                at += 1
            else:
                messages.append(message)
                at = end
        del self._buffer[:at]
        return messages

    @property
    def pending(self) -> int:
        """Bytes held back, of a message that is not complete."""
        return len(self._buffer)

    def _find(self, at: int) -> int:
        """Return where from ``at`` on a message may begin: a prefix whose checksum is right or not complete."""
        begin = at
        while True:
            found = self._buffer.find(MAGIC, at)
            if found < 0:
                at = max(at, len(self._buffer) - _tail(self._buffer))
                break
            at = found
            prefix = self._buffer[at : at + PREFIX]
            if len(prefix) < PREFIX or _is_sound(prefix):
                break
            at += 1
        self.dropped += at - begin
        return at

    def _prefix(self, at: int) -> tuple[int, int, int, int, int] | None:
        """Return version, kind, where header and body end, and their checksum; None if there is too little yet."""
        if len(self._buffer) - at < PREFIX:
            return None
        _, version, kind, _, header, body, check = _FIXED.unpack_from(self._buffer, at)
        return version, kind, at + PREFIX + header, at + PREFIX + header + body, check

    def _message(self, version: int, kind: int, begin: int, middle: int, end: int, check: int) -> Message | None:
        with memoryview(self._buffer) as view:
            if crc32(view[begin:end]) != check:
                return None
            text, body = bytes(view[begin:middle]), bytes(view[middle:end])
        try:
            header = json.loads(text)
        except (ValueError, RecursionError):
            return None
        return Message(kind, header, body, version) if isinstance(header, dict) else None


def _tail(buffer: bytearray) -> int:
    """Return how many bytes at the end may be the beginning of `MAGIC`."""
    return next((size for size in (3, 2, 1) if buffer.endswith(MAGIC[:size])), 0)


def _is_sound(prefix: bytes | bytearray) -> bool:
    (check,) = _CHECK.unpack_from(prefix, _FIXED.size)
    header, body = struct.unpack_from(">II", prefix, 8)
    return bool(crc32(prefix[: _FIXED.size]) == check) and header <= MAX_HEADER and body <= MAX_BODY
