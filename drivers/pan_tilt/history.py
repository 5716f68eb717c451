"""Angles that were measured in the last seconds."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque

_AHEAD = 0.05  # so far beyond the latest measurement the axes are taken to go on as they did [s]


class AngleHistory:
    """Pan and tilt with their times. One thread adds, any may ask."""

    def __init__(self, seconds: float = 3.0) -> None:
        """Remember ``seconds`` [s]."""
        self._seconds = seconds
        self._entries: deque[tuple[float, float, float]] = deque()

    @property
    def latest(self) -> tuple[float, float, float]:
        """Time [s], pan and tilt [rad] of the last measurement; zeros if there was none."""
        try:
            return self._entries[-1]
        except IndexError:
            return 0.0, 0.0, 0.0

    def add(self, stamp: float, pan: float, tilt: float) -> None:
        """Note the angles [rad] at a time [s]; one that is not later than those before is dropped."""
        entries = self._entries
        if entries and stamp <= entries[-1][0]:
            return
        entries.append((stamp, pan, tilt))
        while entries[0][0] < stamp - self._seconds:
            entries.popleft()

    def at(self, stamp: float) -> tuple[float, float]:
        """Return pan and tilt [rad] at a time: on the line between measurements, and a little beyond the last.

        Before the first measurement that is known they are the first; without any they are zero.
        """
        entries = tuple(self._entries)
        if len(entries) < 2 or stamp <= entries[0][0]:
            return entries[0][1:] if entries else (0.0, 0.0)
        index = min(bisect_right(entries, stamp, key=lambda entry: entry[0]), len(entries) - 1)
        (begin, pan, tilt), (end, next_pan, next_tilt) = entries[index - 1], entries[index]
        share = (min(stamp, entries[-1][0] + _AHEAD) - begin) / (end - begin)
        return pan + share * (next_pan - pan), tilt + share * (next_tilt - tilt)
