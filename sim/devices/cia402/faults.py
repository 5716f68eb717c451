"""What ails a drive: error code and register, the list of past errors, and whether a cause is still there."""

from __future__ import annotations

import math

_LISTED = 8
_REGISTER_BITS = (
    (0x2000, 0xF000, 1),
    (0x3000, 0xF000, 2),
    (0x4000, 0xF000, 3),
    (0x8100, 0xFF00, 4),
    (0x8600, 0xFF00, 5),
)


class Faults:
    """Errors of one drive."""

    def __init__(self) -> None:
        self.code = 0
        """Of the present fault; 0 without one."""
        self._until = -math.inf
        self._past: list[int] = []

    def add(self, code: int, until: float) -> None:
        """Note an error whose cause lasts until a time."""
        self.code = code
        self._until = max(self._until, until)
        self._past.insert(0, code)
        del self._past[_LISTED:]

    def gone(self, now: float) -> bool:
        """Return whether the cause has gone, so that the fault can be reset."""
        return now >= self._until

    def reset(self) -> None:
        """Be well again; the list stays."""
        self.code = 0

    def forget(self) -> None:
        """Empty the list."""
        self._past.clear()

    @property
    def register(self) -> int:
        """The error register: bit 0 for any error, and one for its kind."""
        if not self.code:
            return 0
        return 1 | sum(1 << bit for value, mask, bit in _REGISTER_BITS if self.code & mask == value)

    def listed(self, sub: int) -> int:
        """Return an entry of the list of past errors, the latest first; entry 0 is their number."""
        if sub == 0:
            return len(self._past)
        return self._past[sub - 1] if sub <= len(self._past) else 0
