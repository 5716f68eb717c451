"""Standard information packet (SIP): what the robot says of itself ten times a second."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntFlag
from functools import cache
from itertools import chain
from struct import Struct
from struct import error as StructError
from typing import NamedTuple

from drivers.pioneer.codec.errors import PacketError
from drivers.pioneer.codec.framing import encode

STANDING, MOVING = 0x32, 0x33
SIP_TYPES = range(0x30, 0x35)
"""First bytes of payloads that are SIPs; robots send 0x32 and 0x33."""
ANGLE_STEPS = 4096
"""Units of a full turn in headings."""


class Flags(IntFlag):
    """Bits of `Sip.flags`."""

    MOTORS_ENABLED = 1 << 0
    SONAR_1 = 1 << 1
    SONAR_2 = 1 << 2
    SONAR_3 = 1 << 3
    SONAR_4 = 1 << 4
    STOP_PRESSED = 1 << 5
    E_STALL = 1 << 6
    FAR_LEDGE = 1 << 7
    NEAR_LEDGE = 1 << 8
    JOYSTICK_BUTTON = 1 << 9
    CHARGER_POWER = 1 << 10


class Sip(NamedTuple):
    """A SIP in the robot's own units. Fields from ``gripper`` on are None from where an older robot ends the packet."""

    moving: bool = False
    """Whether the wheels turn."""
    x: int = 0
    """0..65535, wraps, or wraps at 32768 [mm / DistConvFactor]."""
    y: int = 0
    heading: int = 0
    """-32768..32767 [4096 a turn], counter-clockwise."""
    left_velocity: int = 0
    """[mm/s / VelConvFactor]"""
    right_velocity: int = 0
    battery: int = 0
    """[0.1 V], at most 255."""
    left_stall: int = 0
    """Bit 0: left wheel stalled; bits 1-7: rear bumper segments."""
    right_stall: int = 0
    """Bit 0: right wheel stalled; bits 1-7: front bumper segments."""
    control: int = 0
    """Heading setpoint [4096 a turn]."""
    flags: int = 0
    """Bits of `Flags`."""
    compass: int = 0
    """[2 degrees]; 0 = none."""
    sonar: tuple[tuple[int, int], ...] = ()
    """Transducer number and range [mm] of those that fired since the last SIP."""
    gripper: int | None = 0
    analog_port: int | None = 0
    analog: int | None = 0
    """0..255 for 0-5 V."""
    digital_in: int | None = 0
    digital_out: int | None = 0
    battery_x10: int | None = 0
    """[0.1 V], without a cap."""
    charge_state: int | None = 0
    """0 not charging, 1 bulk, 2 over-charge, 3 float."""
    rotational_velocity: int | None = 0
    """[0.1 degree/s]"""
    fault_flags: int | None = 0
    lateral_velocity: int | None = 0
    temperature: int | None = -128
    """[degree C]; -127 and -128 = none."""
    charge_percent: int | None = 0
    """0 = not reported."""

    @property
    def left_stalled(self) -> bool:
        """Whether the left wheel is held fast."""
        return bool(self.left_stall & 1)

    @property
    def right_stalled(self) -> bool:
        """Whether the right wheel is held fast."""
        return bool(self.right_stall & 1)

    @property
    def rear_bumpers(self) -> int:
        """Pressed segments of the rear bumper, one bit each."""
        return self.left_stall >> 1

    @property
    def front_bumpers(self) -> int:
        """Pressed segments of the front bumper, one bit each."""
        return self.right_stall >> 1


_FIXED = Struct("<BHHhhhBBBhHBB")
_TAIL_CODES = "BBBBBHBhHhbB"
_TAILS = tuple(Struct("<" + _TAIL_CODES[:count]) for count in range(len(_TAIL_CODES) + 1))
_MISSING = tuple((None,) * (len(_TAIL_CODES) - count) for count in range(len(_TAIL_CODES) + 1))
_WHOLE = len(_TAIL_CODES)
_TAIL_OF_SIZE = tuple(
    max(count for count in range(_WHOLE + 1) if _TAILS[count].size <= size) for size in range(_TAILS[_WHOLE].size + 1)
)
"""Number of tail fields that so many bytes hold."""


@cache
def _sonar(count: int) -> Struct:
    return Struct("<" + "BH" * count)


def is_sip(payload: bytes) -> bool:
    """Return whether a payload is a SIP, by its first byte."""
    return payload[0] in SIP_TYPES


def decode_sip(payload: bytes) -> Sip:
    """Return the SIP in a payload.

    Raises:
        PacketError: It is no SIP, or ends before its sonar readings do.
    """
    size = len(payload)
    if size < _FIXED.size or payload[0] not in SIP_TYPES:
        raise PacketError("is no SIP, or cut short")
    kind, *fixed, count = _FIXED.unpack_from(payload)
    at = _FIXED.size + 3 * count
    if at > size:
        raise PacketError(f"a SIP announces {count} sonar readings and ends before them")
    sonar: tuple[tuple[int, int], ...] = ()
    if count:
        readings = iter(_sonar(count).unpack_from(payload, _FIXED.size))
        sonar = tuple(zip(readings, readings, strict=True))
    fields = _TAIL_OF_SIZE[min(size - at, _TAILS[_WHOLE].size)]
    tail = _TAILS[fields].unpack_from(payload, at)
    return Sip._make((kind == MOVING, *fixed, sonar, *tail, *_MISSING[fields]))


def encode_sip(sip: Sip) -> bytes:
    """Return the packet of a SIP, cut before the first tail field that is None. x and y wrap at 16 bits.

    Raises:
        ValueError: A field is out of range, or there are too many sonar readings.
    """
    _, x, y, *fixed = sip[:12]
    kind = MOVING if sip.moving else STANDING
    tail = list(_until_none(sip[13:]))
    try:
        payload = _FIXED.pack(kind, x & 0xFFFF, y & 0xFFFF, *fixed, len(sip.sonar))
        payload += _sonar(len(sip.sonar)).pack(*chain.from_iterable(sip.sonar))
        payload += _TAILS[len(tail)].pack(*tail)
    except StructError as error:
        raise ValueError(f"a field of the SIP is out of range: {error}") from error
    return encode(payload)


def _until_none(values: Iterable[int | None]) -> Iterable[int]:
    for value in values:
        if value is None:
            return
        yield value
