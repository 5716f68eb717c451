"""Another clock's times on our own."""

from __future__ import annotations

from collections import deque


class ClockOffset:
    """Tells how far another clock is behind ours, from messages that say when they were sent.

    A message is never read before it was sent, so each bounds the offset from above, and the one that was least
    delayed bounds it best. Only the last seconds count, so that the offset follows clocks that drift or slip.
    """

    def __init__(self, seconds: float = 3.0) -> None:
        """Go by the messages of the last ``seconds`` [s]."""
        self._seconds = seconds
        self._bounds: deque[tuple[float, float]] = deque()  # times read, offsets; both rising

    def add(self, sent: float, read: float) -> None:
        """Note that a message sent at ``sent`` on the other clock was read at ``read`` on ours [s]."""
        offset = read - sent
        while self._bounds and self._bounds[-1][1] >= offset:
            self._bounds.pop()
        self._bounds.append((read, offset))
        while self._bounds[0][0] < read - self._seconds:
            self._bounds.popleft()

    def __call__(self, stamp: float) -> float:
        """Return a time of the other clock on ours [s]; as it is before the first message."""
        return stamp + (self._bounds[0][1] if self._bounds else 0.0)
