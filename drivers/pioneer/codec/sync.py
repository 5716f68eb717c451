"""The handshake: three synchronising packets, the last of which the robot answers with its name."""

from __future__ import annotations

from typing import NamedTuple

from drivers.pioneer.codec.errors import PacketError
from drivers.pioneer.codec.framing import encode


class Identity(NamedTuple):
    """How a robot introduces itself. Class and subclass choose its parameters."""

    name: str
    """Free text."""
    class_name: str
    """``Pioneer``."""
    subclass: str
    """``p3at-sh``; to be compared without case."""


def encode_sync(number: int) -> bytes:
    """Return the packet SYNC0, SYNC1 or SYNC2; the robot echoes the first two."""
    return encode(bytes((number,)))


def sync_number(payload: bytes) -> int | None:
    """Return 0, 1 or 2 if the payload is a client's SYNC: exactly that one byte. Otherwise it is None."""
    return payload[0] if len(payload) == 1 and payload[0] <= 2 else None


def encode_identity(identity: Identity) -> bytes:
    """Return the packet that answers SYNC2.

    Raises:
        ValueError: The texts are not ASCII, or too long.
    """
    return encode(b"\x02" + b"".join(encode_text(text) for text in identity))


def decode_identity(payload: bytes) -> Identity:
    """Return the name in the answer to SYNC2; texts that are missing are empty.

    Raises:
        PacketError: It is not such an answer.
    """
    if payload[:1] != b"\x02":
        raise PacketError("is no answer to SYNC2")
    texts = [decode_text(text) for text in payload[1:].split(b"\0")] + ["", "", ""]
    return Identity(*texts[:3])


def encode_text(text: str) -> bytes:
    """Return a text as the robot sends it: ASCII and a zero byte.

    Raises:
        ValueError: It is not ASCII, or holds a zero.
    """
    data = text.encode("ascii")
    if 0 in data:
        raise ValueError(f"{text!r} holds a zero byte, which would end it")
    return data + b"\0"


def decode_text(data: bytes) -> str:
    """Return the text of some bytes; what is not ASCII becomes a question mark."""
    return data.decode("ascii", errors="replace").replace("\ufffd", "?")
