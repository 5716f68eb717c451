"""The wall clock as a mission's clock."""

from __future__ import annotations

import time


class WallClock:
    """Real time since its start, monotonic: what missions on a robot go by."""

    def __init__(self) -> None:
        self._zero = time.monotonic()

    def now(self) -> float:
        """Return the time since the start [s]."""
        return time.monotonic() - self._zero

    def wait_until(self, stamp: float) -> None:
        """Sleep until ``stamp`` [s]; return at once if that is past."""
        time.sleep(max(stamp - self.now(), 0.0))
