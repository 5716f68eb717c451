"""What the client tells the robot: a command number and at most one argument."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from drivers.pioneer.codec.framing import encode

POSITIVE, NEGATIVE, STRING = 0x3B, 0x1B, 0x2B
MAX_STRING = 190
"""Longest string argument [bytes]."""


class CommandNumber(IntEnum):
    """Numbers of the commands. 0, 1 and 2 mean SYNC0, SYNC1 and SYNC2 until the handshake is finished."""

    PULSE = 0
    OPEN = 1
    CLOSE = 2
    POLLING = 3
    ENABLE = 4
    SETA = 5
    SETV = 6
    SETO = 7
    MOVE = 8
    ROTATE = 9
    SETRV = 10
    VEL = 11
    HEAD = 12
    DHEAD = 13
    SAY = 15
    CONFIG = 18
    ENCODER = 19
    RVEL = 21
    DCHEAD = 22
    SETRA = 23
    SONAR = 28
    STOP = 29
    DIGOUT = 30
    VEL2 = 32
    ADSEL = 35
    IOREQUEST = 40
    PTUPOS = 41
    TTY2 = 42
    GETAUX = 43
    BUMPSTALL = 44
    SONARCYCLE = 48
    HOSTBAUD = 50
    AUX1BAUD = 51
    AUX2BAUD = 52
    AUX3BAUD = 53
    E_STOP = 55
    E_STALL = 56
    E_STOP_ALTERNATIVE = 57
    TTY4 = 60
    GETAUX3 = 61
    BATTERYINFO = 62
    TTY3 = 66
    GETAUX2 = 67
    BATTEST = 250
    RESET = 253


BAUD_CODES = {9600: 0, 19200: 1, 38400: 2, 57600: 3, 115200: 4}
"""Argument of HOSTBAUD and of AUX1BAUD to AUX3BAUD for each speed."""


@dataclass(frozen=True, slots=True)
class Command:
    """A command as the robot receives it."""

    number: int
    """A `CommandNumber`, or one that is not known."""
    argument: int | bytes | None = None
    """Signed integer, string, or None if there is none: several commands come with and without."""
    data: bytes = b""
    """All bytes after the argument's type: commands with several values are unpacked from here."""

    def integer(self, default: int = 0) -> int:
        """Return the integer argument, or the default if there is none."""
        return self.argument if isinstance(self.argument, int) else default

    def string(self) -> bytes:
        """Return the string argument; empty if there is none."""
        return self.argument if isinstance(self.argument, bytes) else b""

    def halves(self) -> tuple[int, int]:
        """Return high and low byte of the signed argument, each in -128..127: VEL2's left and right."""
        value = self.integer() & 0xFFFF
        high, low = value >> 8, value & 0xFF
        return high - ((high & 0x80) << 1), low - ((low & 0x80) << 1)


def encode_command(number: int, argument: int | str | bytes | None = None) -> bytes:
    """Return the packet of a command.

    Args:
        number: A `CommandNumber`.
        argument: Integer in -65535..65535, sent as sign and magnitude; a string, sent with its length; or None.

    Raises:
        ValueError: The argument does not fit.
    """
    head = bytes((number,))
    if argument is None:
        return encode(head)
    if isinstance(argument, int):
        if abs(argument) > 0xFFFF:
            raise ValueError(f"command {number}: {argument} does not fit 16 bits and a sign")
        kind = POSITIVE if argument >= 0 else NEGATIVE
        return encode(head + bytes((kind,)) + abs(argument).to_bytes(2, "little"))
    text = argument.encode("ascii") if isinstance(argument, str) else argument
    if len(text) > MAX_STRING:
        raise ValueError(f"command {number}: a string of {len(text)} bytes is too long (at most {MAX_STRING})")
    return encode(head + bytes((STRING, len(text))) + text)


def encode_wheels(left: int, right: int) -> bytes:
    """Return VEL2 for wheel speeds in -128..127 [20 mm/s]: two bytes that pass as one signed number."""
    value = (left << 8 | right & 0xFF) & 0xFFFF
    return encode_command(CommandNumber.VEL2, value - ((value & 0x8000) << 1))


def decode_command(payload: bytes) -> Command:
    """Return the command in a payload; what is cut short counts as without argument.

    Raises:
        ValueError: The payload is empty.
    """
    if not payload:
        raise ValueError("an empty payload holds no command")
    number, kind, data = payload[0], payload[1:2], payload[2:]
    if kind == bytes((STRING,)) and data:
        return Command(number, data[1 : 1 + data[0]], data)
    if kind in (bytes((POSITIVE,)), bytes((NEGATIVE,))) and len(data) >= 2:
        magnitude = int.from_bytes(data[:2], "little")
        return Command(number, magnitude if kind[0] == POSITIVE else -magnitude, data)
    return Command(number, None, data)
