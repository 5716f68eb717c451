"""Readings of one sweep."""

from __future__ import annotations

from dataclasses import dataclass

from drivers.lidar.codec.blocks import pack_block, unpack_block
from drivers.lidar.codec.errors import CodecError
from drivers.lidar.codec.lines import seal, unseal
from drivers.lidar.codec.numbers import (
    CLOCK_DIGITS,
    CLOCK_SPAN,
    Numbers,
    decode_number,
    encode_number,
    encode_numbers,
    join_digits,
)

_CLOCK_LINE = CLOCK_DIGITS + 2


@dataclass(frozen=True, slots=True, eq=False)
class Readings:
    """What a sensor measured in one sweep."""

    clock: int
    """The sensor's clock [ms], which begins again at 0 after 16777215."""
    ranges: Numbers
    """(n,) [mm]; values outside the sensor's range are codes."""
    intensities: Numbers | None = None
    """(n,) echo strengths, if they were asked for."""


def decode_readings(command: str, body: bytes) -> Readings:
    """Return the readings in the answer to a G or M command.

    Args:
        command: Its two letters.
        body: All that follows the status line, up to the last line feed before the empty line.

    Raises:
        CodecError: A checksum or a length is wrong.
    """
    head, block = body[:_CLOCK_LINE], body[_CLOCK_LINE:]
    if len(head) != _CLOCK_LINE or head[-1:] != b"\n":
        raise CodecError(f"no time stamp: {head!r}")
    clock = decode_number(unseal(head[:-1]))
    numbers = join_digits(unpack_block(block), 2 if command[1] == "S" else 3)
    if command[1] != "E":
        return Readings(clock, numbers)
    if len(numbers) % 2:
        raise CodecError("a range without its intensity")
    return Readings(clock, numbers[0::2], numbers[1::2])


def encode_readings(clock: int, values: Numbers, digits: int) -> bytes:
    """Return time stamp line and data lines.

    Args:
        clock: The sensor's clock [ms], of any size.
        values: (n,) ranges, or ranges and intensities in turn.
        digits: Characters to a value.

    Raises:
        ValueError: A value needs more characters.
    """
    stamp = seal(encode_number(clock % CLOCK_SPAN, CLOCK_DIGITS))
    return stamp + b"\n" + pack_block(encode_numbers(values, digits))
