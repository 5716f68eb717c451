"""How a decoder did."""

from __future__ import annotations

from dataclasses import dataclass

PACKETS = 2  # to recover
GROWTH = 50_000  # of what is kept for good: layouts of packets of every length, the buffer's reserve [bytes]


@dataclass
class Result:
    """What became of some bytes of nonsense."""

    eaten: int = 0
    """[bytes]"""
    recoveries: int = 0
    worst: int = 0
    """Packets it needed to recover, at most."""
    growth: int = 0
    """Memory gained from half way to the end [bytes]."""
    peak: int = 0
    """[bytes]"""
    kept: int = GROWTH
    """What it may keep for good [bytes]."""
    error: str = ""

    @property
    def passed(self) -> bool:
        return not self.error and self.worst <= PACKETS and self.growth < self.kept
