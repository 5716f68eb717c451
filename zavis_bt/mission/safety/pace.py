"""How steadily commands follow each other."""

from __future__ import annotations

from collections import deque

_LATELY, _WINDOW = 10, 20  # turns that decide the reaction time, and whether late ones pile up
_OFTEN = 3  # so many late turns in the window are no accident


class Pace:
    """Watches the time from command to command: what the base drives on without being told otherwise."""

    def __init__(self, period: float, limit: float) -> None:
        """Expect a period [s]; turns longer than ``limit`` [s] are late."""
        self._period, self._limit = period, limit
        self._last: float | None = None
        self._recent: deque[float] = deque(maxlen=_LATELY)
        self._lateness: deque[bool] = deque(maxlen=_WINDOW)

    def note(self, now: float) -> float:
        """Note that a command is due now [s]; return how long the last one has lasted, 0 for the first [s]."""
        lasted = 0.0 if self._last is None else now - self._last
        self._last = now
        self._recent.append(min(lasted, self._limit))
        self._lateness.append(lasted > self._limit)
        return lasted

    def rest(self) -> None:
        """Note that the base was stopped: how long it stands does not matter."""
        self._last = None

    @property
    def reaction(self) -> float:
        """Time until the base can be told otherwise: the period, or what it took lately [s]."""
        return max(self._period, *self._recent)

    @property
    def late(self) -> bool:
        """Whether the latest turn took too long."""
        return bool(self._lateness) and self._lateness[-1]

    @property
    def often_late(self) -> bool:
        """Whether turns took too long again and again."""
        return sum(self._lateness) >= _OFTEN
