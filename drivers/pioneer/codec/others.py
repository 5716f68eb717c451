"""What else a robot sends: wheel encoders, bytes from its auxiliary serial ports, and types without use here."""

from __future__ import annotations

from enum import IntEnum
from struct import Struct
from typing import NamedTuple

from drivers.pioneer.codec.errors import PacketError
from drivers.pioneer.codec.framing import encode


class PacketType(IntEnum):
    """First byte of the payloads that a robot sends."""

    CONFIG = 0x20
    STANDING = 0x32
    MOVING = 0x33
    ENCODER = 0x90
    GYRO = 0x98
    AUX1 = 0xB0
    AUX2 = 0xB8
    AUX3 = 0xC8
    GRIPPER = 0xE0
    IO = 0xF0
    JOYSTICK = 0xF8
    OUT_OF_STEP = 0xFF


class Encoders(NamedTuple):
    """Encoder packet: ticks of each side since the robot was switched on."""

    left: int
    right: int


class AuxData(NamedTuple):
    """SERAUX packet: raw bytes from a device on an auxiliary port; its answer may come in several of them."""

    port: int
    """1, 2 or 3."""
    data: bytes


_ENCODERS = Struct("<ii")
_AUX_TYPES = {1: PacketType.AUX1, 2: PacketType.AUX2, 3: PacketType.AUX3}
_AUX_PORTS = {int(kind): port for port, kind in _AUX_TYPES.items()}


def encode_encoders(encoders: Encoders) -> bytes:
    """Return an encoder packet; ticks are 32-bit signed."""
    return encode(bytes((PacketType.ENCODER,)) + _ENCODERS.pack(*encoders))


def decode_encoders(payload: bytes) -> Encoders:
    """Return the ticks in an encoder packet.

    Raises:
        PacketError: It is none, or cut short.
    """
    if payload[:1] != bytes((PacketType.ENCODER,)) or len(payload) < 1 + _ENCODERS.size:
        raise PacketError("is no encoder packet, or cut short")
    return Encoders(*_ENCODERS.unpack_from(payload, 1))


def encode_aux(aux: AuxData) -> bytes:
    """Return a SERAUX packet, for at most 194 bytes.

    Raises:
        ValueError: There is no such port, or too much data.
    """
    if aux.port not in _AUX_TYPES:
        raise ValueError(f"there is no auxiliary port {aux.port} (1, 2 or 3)")
    return encode(bytes((_AUX_TYPES[aux.port],)) + aux.data)


def decode_aux(payload: bytes) -> AuxData:
    """Return port and bytes of a SERAUX packet.

    Raises:
        PacketError: It is none.
    """
    port = _AUX_PORTS.get(payload[0]) if payload else None
    if port is None:
        raise PacketError("is no packet from an auxiliary port")
    return AuxData(port, payload[1:])
