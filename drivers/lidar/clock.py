"""The sensor's clock, read on the mission's."""

from __future__ import annotations

import math
from collections.abc import Iterable

from drivers.lidar.codec import CLOCK_SPAN

_WINDOW = 10.0  # [s]; crystals part by less than 1 ms in that time
_JUMP = 0.5  # [s] by which a scan is earlier than it can be, if the sensor's clock has jumped


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
        self._time: float | None = None  # of the sensor without wrap
        self._raw = 0
        self._delay: float | None = None
        self._least = self._least_before = math.inf  # of arrival minus sensor's time, in this window and the last
        self._window_end = -math.inf
        if quickest is not None:
            asked, answered, self._raw = quickest
            self._time = self._raw / 1000
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
        time = self._unwrap(raw)
        if arrival - time < self._expected() - _JUMP:  # a scan may come late, but not early
            self._restart()
        if arrival >= self._window_end:
            self._close_window(arrival)
        self._least = min(self._least, arrival - time)
        return min(time + self._offset(), arrival)

    def _expected(self) -> float:
        """Return what arrival minus sensor's time is at least, by all that is known [s]."""
        known = min(self._least, self._least_before)
        if math.isfinite(known):
            return known
        return self._synchronised if self._delay is None and self._synchronised is not None else -math.inf

    def _offset(self) -> float:
        if self._delay is None and self._synchronised is not None:
            return self._synchronised
        return min(self._least, self._least_before) - (self._delay or 0.0)

    def _close_window(self, arrival: float) -> None:
        if self._delay is None and self._synchronised is not None and math.isfinite(self._least):
            self._delay = max(self._least - self._synchronised, 0.0)
        self._least_before, self._least = self._least, math.inf
        self._window_end = arrival + _WINDOW

    def _unwrap(self, raw: int) -> float:
        """Return the sensor's time without wrap [s]."""
        passed = 0 if self._time is None else (raw - self._raw + CLOCK_SPAN // 2) % CLOCK_SPAN - CLOCK_SPAN // 2
        self._time = raw / 1000 if self._time is None else self._time + passed / 1000
        self._raw = raw
        if passed < -1000 * _JUMP:
            self._restart()
        return self._time

    def _restart(self) -> None:
        """Find out anew how the clocks stand, with the delay of before: the sensor's has jumped."""
        if self._delay is None and self._synchronised is not None:
            known = min(self._least, self._least_before)
            self._delay = max(known - self._synchronised, 0.0) if math.isfinite(known) else 0.0
        self._least = self._least_before = math.inf
