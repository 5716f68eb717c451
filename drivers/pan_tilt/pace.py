"""A steady beat, and how steady it was."""

from __future__ import annotations

import time
from collections import deque

_LOST = 4  # periods behind from which on lost beats are given up
_MEMORY = 2000


class Pace:
    """Waits for deadlines that lie a period apart, whatever was done between them."""

    def __init__(self, period: float) -> None:
        """Beat every ``period`` seconds, the first time at once."""
        self.period = period
        self.lost = 0
        """Beats that were given up."""
        self._due = time.monotonic()
        self._lateness: deque[float] = deque(maxlen=_MEMORY)

    def restart(self) -> None:
        """Begin anew: the next beat is now."""
        self._due = time.monotonic()

    def wait(self) -> None:
        """Wait for the next beat; return at once if it is over."""
        now = time.monotonic()
        if now - self._due > _LOST * self.period:
            self.lost += int((now - self._due) / self.period)
            self._due = now
        time.sleep(max(self._due - now, 0.0))
        self._lateness.append(time.monotonic() - self._due)
        self._due += self.period

    def lateness(self, share: float) -> float:
        """Return the lateness [s] that this share of the latest beats kept below; 0 before the first."""
        return quantile(self._lateness, share)


def quantile(values: deque[float], share: float) -> float:
    """Return the value that this share of the values does not exceed; 0 for none."""
    ordered = sorted(tuple(values))
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)] if ordered else 0.0
