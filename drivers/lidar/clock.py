"""The sensor's clock, read on the mission's."""

from __future__ import annotations

import math
from collections.abc import Iterable

from drivers.lidar.codec import CLOCK_SPAN

_WINDOW = 10.0  # [s]; crystals part by less than 1 ms in that time
_JUMP = 0.5  # [s] between what the two clocks say has passed; more is a restarted sensor


class SensorClock:
    """Turns the sensor's time stamps into the mission's time.

    The sensor counts milliseconds with 24 bits, from whenever it was switched on, with a crystal of its own. What a
    scan's arrival minus its stamp is at least, over the last seconds, follows the crystal; the time between
    measurement and arrival that is in it was found once, with the clock questions of the time mode. Without these it
    is taken as nothing.
    """

    def __init__(self, exchanges: Iterable[tuple[float, float, int]] = ()) -> None:
        """Set the clock.

        Args:
            exchanges: When the time was asked for and when the answer was there [s], and the sensor's clock [ms]. The
                quickest counts, and the sensor has looked at its clock half-way.
        """
        quickest = min(exchanges, key=lambda exchange: exchange[1] - exchange[0], default=None)
        self._synchronised: float | None = None
        self._last: tuple[float, float] | None = None  # sensor's time without wrap, arrival
        self._raw = 0
        self._delay: float | None = None
        self._least = self._least_before = math.inf  # of arrival minus sensor's time, in this window and the last
        self._window_end = -math.inf
        if quickest is not None:
            asked, answered, self._raw = quickest
            self._last = self._raw / 1000, answered
            self._synchronised = (asked + answered) / 2 - self._raw / 1000
            self._window_end = answered + _WINDOW

    @property
    def synchronised(self) -> bool:
        """Whether the sensor was asked for its time."""
        return self._synchronised is not None

    def stamp(self, raw: int, arrival: float) -> float:
        """Return when a scan was measured.

        Args:
            raw: The scan's stamp [ms].
            arrival: When its last byte was there, by the mission's clock [s].

        Returns:
            Time on the mission's clock, never after the arrival [s].
        """
        time = self._unwrap(raw, arrival)
        if arrival >= self._window_end:
            self._close_window(arrival)
        self._least = min(self._least, arrival - time)
        return min(time + self._offset(), arrival)

    def _offset(self) -> float:
        if self._delay is None and self._synchronised is not None:
            return self._synchronised
        return min(self._least, self._least_before) - (self._delay or 0.0)

    def _close_window(self, arrival: float) -> None:
        if self._delay is None and self._synchronised is not None and math.isfinite(self._least):
            self._delay = max(self._least - self._synchronised, 0.0)
        self._least_before, self._least = self._least, math.inf
        self._window_end = arrival + _WINDOW

    def _unwrap(self, raw: int, arrival: float) -> float:
        """Return the sensor's time without wrap [s]; after a jump of its clock, begin the windows anew."""
        if self._last is None:
            time = raw / 1000
        else:
            before, arrived = self._last
            passed = (raw - self._raw + CLOCK_SPAN // 2) % CLOCK_SPAN - CLOCK_SPAN // 2
            time = before + passed / 1000
            if abs(passed / 1000 - (arrival - arrived)) > _JUMP:
                self._restart(arrival - time)
        self._last, self._raw = (time, arrival), raw
        return time

    def _restart(self, difference: float) -> None:
        """Take ``difference`` [s] for the least delay, and the synchronisation as it was before the jump."""
        if self._delay is None and self._synchronised is not None:
            known = min(self._least, self._least_before)
            self._delay = max(known - self._synchronised, 0.0) if math.isfinite(known) else 0.0
        self._least, self._least_before = difference, math.inf
