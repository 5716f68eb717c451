"""What a decoder raises."""

from __future__ import annotations


class CodecError(ValueError):
    """Bytes are not what SCIP 2.0 allows: a wrong checksum, length or character."""
