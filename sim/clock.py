"""Simulated time: in lock step, or paced by the wall clock."""

from __future__ import annotations

import time

from sim.physics import Physics

_LOST = 0.5  # [s] behind the wall clock from which on it is given up to catch up


class SimClock:
    """The mission's clock; to wait is to advance the world."""

    def __init__(self, physics: Physics, *, real_time: bool = False) -> None:
        """Tell the time of a world.

        Args:
            physics: The world.
            real_time: Sleep, so that simulated time passes as fast as the wall clock's. The world does not run on
                while nobody waits; small delays are caught up with, pauses are not.
        """
        self._physics = physics
        self._real_time = real_time
        self._wall_at_zero: float | None = None

    def now(self) -> float:
        """Return the simulated time [s]."""
        return self._physics.now

    def wait_until(self, stamp: float) -> None:
        """Advance the world to ``stamp`` [s], rounded up to a step; nothing happens if that is past."""
        if self._real_time:
            self._sleep_until(stamp)
        self._physics.advance_to(stamp)

    def _sleep_until(self, stamp: float) -> None:
        wall = time.monotonic()
        if self._wall_at_zero is None or wall - self._wall_at_zero - self.now() > _LOST:
            self._wall_at_zero = wall - self.now()
        time.sleep(max(self._wall_at_zero + stamp - wall, 0.0))
