"""Blocks of data lines: at most 64 characters, a check character and a line feed each (SCIP 2.0: block splitting)."""

from __future__ import annotations

import numpy as np

from drivers.lidar.codec.errors import CodecError
from drivers.lidar.codec.lines import MASK, OFFSET, seal
from drivers.lidar.codec.numbers import Digits

_WIDTH = 64
_LINE = _WIDTH + 2
_LF = 10


def pack_block(characters: bytes) -> bytes:
    """Return the characters cut into lines, each with its check character and line feed."""
    full, rest = divmod(len(characters), _WIDTH)
    lines = np.empty((full, _LINE), dtype=np.uint8)
    lines[:, :_WIDTH] = np.frombuffer(characters, dtype=np.uint8, count=full * _WIDTH).reshape(full, _WIDTH)
    # only the low six bits of the sum count, so bytes may overflow
    lines[:, _WIDTH] = (np.add.reduce(lines[:, :_WIDTH], axis=1, dtype=np.uint8) & MASK) + OFFSET
    lines[:, _WIDTH + 1] = _LF
    tail = seal(characters[-rest:]) + b"\n" if rest else b""
    return lines.tobytes() + tail


def unpack_block(block: bytes) -> Digits:
    """Return the six-bit values of all lines, shape (n,), after checking every line.

    The check character covers six bits of each byte only; that every character is one of the 64 catches the other two.

    Raises:
        CodecError: A check character, a line's length or a character is wrong.
    """
    data = np.frombuffer(block, dtype=np.uint8)
    full, rest = divmod(len(data), _LINE)
    if rest in (1, 2):
        raise CodecError("a data line without data")
    digits = np.empty(full * _WIDTH + max(rest - 2, 0), dtype=np.uint8)
    if full:
        lines, values = data[: full * _LINE].reshape(full, _LINE), digits[: full * _WIDTH].reshape(full, _WIDTH)
        np.subtract(lines[:, :_WIDTH], OFFSET, out=values)
        # 64 times the offset vanishes in six bits: the sum of the values has the check character's
        sums = np.add.reduce(values, axis=1, dtype=np.uint8)
        sums &= MASK
        sums += OFFSET
        if (lines[:, _WIDTH + 1] != _LF).any() or (lines[:, _WIDTH] != sums).any():
            raise CodecError("wrong checksum in the data")
    if rest:
        last = block[full * _LINE :]
        if last[-1] != _LF or seal(last[:-2]) != last[:-1]:
            raise CodecError("wrong checksum in the data")
        np.subtract(data[full * _LINE : -2], OFFSET, out=digits[full * _WIDTH :])
    if digits.max(initial=0) > MASK:
        raise CodecError("a character in the data that stands for no number")
    return digits
