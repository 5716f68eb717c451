"""When a camera takes its pictures."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable

from sim.frame import SimFrame

KEPT = 600
"""Pictures that can be looked at later, a minute of them at 10 Hz; they are poses, a picture is made when looked at."""


class Shutter:
    """Takes a picture when somebody wants a new one, but no more of them than the camera can. Any thread may ask."""

    def __init__(self, take: Callable[[], SimFrame], rate: float) -> None:
        """Set up a shutter.

        Args:
            take: Takes a picture.
            rate: Pictures a second, at most [Hz].
        """
        self._take, self._period = take, 1 / rate
        self._number, self._due = 0, 0.0
        self._frame: SimFrame | None = None
        self._kept: deque[tuple[int, SimFrame]] = deque(maxlen=KEPT)
        self._guard, self._closed = threading.Lock(), threading.Event()
        self.frozen = False
        """Whether no more pictures are taken."""

    def newer_than(self, number: int, wait: float) -> tuple[int, SimFrame | None]:
        """Return the latest picture and its number.

        Args:
            number: Of the picture that is known; 0 for none.
            wait: How long to wait for another one [s].

        Returns:
            Numbers count from 1. No picture, and the latest one's number, if there is none but the known one.
        """
        until = time.monotonic() + wait
        while True:
            with self._guard:
                self._take_if_due()
                if self._number != number:
                    return self._number, self._frame
                due = until if self.frozen else min(self._due, until)
            pause = due - time.monotonic()
            if self._closed.wait(max(pause, 0.0)) or time.monotonic() >= until:
                return self._number, None

    def taken(self, number: int) -> SimFrame | None:
        """Return an earlier picture, not rendered yet, or None if it is no longer kept."""
        with self._guard:
            frame = dict(self._kept).get(number)
        return None if frame is None else frame.unrendered()

    @property
    def oldest(self) -> int:
        """Number of the oldest picture that is kept; 0 if there is none."""
        with self._guard:
            return self._kept[0][0] if self._kept else 0

    def close(self) -> None:
        """Let all who wait go."""
        self._closed.set()

    def _take_if_due(self) -> None:
        now = time.monotonic()
        if not self.frozen and now >= self._due:
            self._number, self._frame = self._number + 1, self._take()
            self._kept.append((self._number, self._frame.unrendered()))  # only the latest one's pixels take up memory
            self._due = max(self._due + self._period, now)
