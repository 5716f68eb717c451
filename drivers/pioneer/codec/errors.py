"""What a decoder says of a packet that arrived whole and still makes no sense."""

from __future__ import annotations


class PacketError(ValueError):
    """A packet with a valid checksum is not what its type says, or is cut short."""
