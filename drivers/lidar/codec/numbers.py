"""Numbers as characters of six bits each, highest first (SCIP 2.0: 2-, 3- and 4-character encoding)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivers.lidar.codec.errors import CodecError
from drivers.lidar.codec.lines import MASK, OFFSET

CLOCK_DIGITS = 4
"""Characters of a time stamp."""
CLOCK_SPAN = 1 << 6 * CLOCK_DIGITS
"""A time stamp counts from 0 up to here and begins again [ms]."""
Numbers = NDArray[np.int32]
Digits = NDArray[np.uint8]


def encode_number(value: int, digits: int) -> bytes:
    """Return a number as ``digits`` characters.

    Raises:
        ValueError: It is negative or needs more characters.
    """
    if not 0 <= value < 1 << 6 * digits:
        raise ValueError(f"{value} does not fit {digits} characters (0 to {(1 << 6 * digits) - 1})")
    return bytes((value >> 6 * place & MASK) + OFFSET for place in reversed(range(digits)))


def decode_number(text: bytes) -> int:
    """Return the number that the characters stand for.

    Raises:
        CodecError: A character is none of the 64.
    """
    value = 0
    for character in text:
        if not 0 <= character - OFFSET <= MASK:
            raise CodecError(f"not a number: {text!r}")
        value = value << 6 | character - OFFSET
    return value


def encode_numbers(values: Numbers, digits: int) -> bytes:
    """Return (n,) numbers, each as ``digits`` characters, one after the other.

    Raises:
        ValueError: One is negative or needs more characters.
    """
    if len(values) and not 0 <= values.min() <= values.max() < 1 << 6 * digits:
        raise ValueError(f"numbers do not fit {digits} characters (0 to {(1 << 6 * digits) - 1})")
    characters = np.empty((len(values), digits), dtype=np.uint8)
    for place in range(digits):
        characters[:, place] = (values >> 6 * (digits - 1 - place) & MASK) + OFFSET
    return characters.tobytes()


def join_digits(digits: Digits, length: int) -> Numbers:
    """Return the numbers that groups of ``length`` six-bit values stand for.

    Args:
        digits: (n · length,) values of 0 to 63.
        length: Values to a number.

    Raises:
        CodecError: The last number is not complete.
    """
    if len(digits) % length:
        raise CodecError(f"{len(digits)} characters are no whole number of {length}-character readings")
    numbers = digits[0::length].astype(np.int32)
    for place in range(1, length):
        numbers <<= 6
        numbers |= digits[place::length]
    return numbers
