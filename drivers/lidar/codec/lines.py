"""Lines and their checksum character (SCIP 2.0: check codes)."""

from __future__ import annotations

from drivers.lidar.codec.errors import CodecError

OFFSET = 0x30
"""What is added to six bits to make a printable character."""
MASK = 0x3F
"""Six bits."""


def checksum(content: bytes) -> int:
    """Return the check character of a line's content: the low six bits of the sum of its bytes, made printable."""
    return (sum(content) & MASK) + OFFSET


def seal(content: bytes) -> bytes:
    """Return the content with its check character."""
    return content + bytes((checksum(content),))


def seal_information(content: bytes) -> bytes:
    """Return a line of VV, PP or II: a semicolon stands before the check character and is not counted."""
    return content + b";" + bytes((checksum(content),))


def unseal(line: bytes) -> bytes:
    """Return the content of a line without line end.

    Raises:
        CodecError: The check character is wrong, or there is none.
    """
    content = line[:-1]
    if not content or checksum(content) != line[-1]:
        raise CodecError(f"wrong checksum: {line!r}")
    return content


def unseal_information(line: bytes) -> bytes:
    """Return the content of a line of VV, PP or II; the semicolon before the check character may be counted or not.

    Raises:
        CodecError: The check character is wrong, or there is none.
    """
    content = line[:-1]
    if content.endswith(b";") and line[-1] == checksum(content[:-1]):
        return content[:-1]
    return unseal(line).removesuffix(b";")
