"""The steady beat at which the robot hears from the driver: velocities while it moves, signs of life while not."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable

from drivers.pioneer.codec import CommandNumber, encode_command
from drivers.pioneer.connection import EMERGENCY_STOP, HALT
from zavis_bt.errors import DeviceError

_REPEATS = 3  # there are no acknowledgements: what must arrive is said so often
_PULSE_EVERY = 0.25  # [s]
_KEPT = 400
_PULSE = encode_command(CommandNumber.PULSE)

Write = Callable[[bytes], None]


class Cadence:
    """Sends the current velocity at a fixed rate, from a thread of its own.

    A first velocity goes out at once, changes to it at the next beat. Beats are counted from that first one and not
    from the one before, so that delays do not add up. All writing to an attached line happens under one lock: after
    `stop` has returned no velocity is on its way.
    """

    def __init__(self, period: float, timeout: float) -> None:
        """Wait for a line.

        Args:
            period: Between two beats [s].
            timeout: The base is halted if no velocity was set for so long [s].
        """
        self._period, self._timeout = period, timeout
        self._changed = threading.Condition()
        self._write: Write | None = None
        self._velocity: bytes | None = None
        self._set_at = 0.0
        self._repeats, self._halting = 0, HALT
        self._barred = False
        self._due = self._beat = 0.0
        self._ended = False
        self.failure: DeviceError | None = None
        """Why the last line took nothing any more."""
        self.intervals: deque[float] = deque(maxlen=_KEPT)
        """Between velocities in a row [s]."""
        self._sent_at: float | None = None
        self._thread = threading.Thread(target=self._run, name="pioneer cadence", daemon=True)
        self._thread.start()

    def attach(self, write: Write) -> None:
        """Begin to send on a line: signs of life, and velocities once ``bar(False)`` allows them."""
        with self._changed:
            self._write, self.failure, self._barred = write, None, True
            self._due = time.monotonic()
            self._changed.notify()

    def detach(self, last_word: bytes = b"") -> None:
        """Drop the velocity and send nothing any more but a last word, which may fail."""
        with self._changed:
            self._forget()
            self._repeats = 0
            self._send(last_word)
            self._write = None

    def bar(self, barred: bool) -> None:
        """Take no velocity while the base cannot move anyway, so that it does not start when it can again."""
        with self._changed:
            if barred and not self._barred:
                self._halt(HALT)
            self._barred = barred

    def set(self, velocity: int, rotation: int) -> bool:
        """Send this velocity from now on [mm/s, degree/s]; return False if there is no line."""
        packets = encode_command(CommandNumber.VEL, velocity) + encode_command(CommandNumber.RVEL, rotation)
        with self._changed:
            if self._write is None:
                return False
            if self._barred:
                return True
            starting = self._velocity is None
            self._velocity, self._set_at, self._repeats = packets, time.monotonic(), 0
            if starting:
                self._due = self._set_at
                self._changed.notify()
            return True

    def stop(self) -> None:
        """Send an emergency stop now, from the caller's thread, and no velocity after it; never raises."""
        with self._changed:
            self._halt(EMERGENCY_STOP)
            self._send(EMERGENCY_STOP)

    def say(self, packets: bytes) -> None:
        """Send packets now, besides the velocities."""
        with self._changed:
            self._send(packets)

    def close(self) -> None:
        """End the thread; may be called twice."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _run(self) -> None:
        with self._changed:
            while not self._ended:
                wait = self._due - time.monotonic() if self._write else None
                if wait is None or wait > 0:
                    self._changed.wait(wait)
                else:
                    self._do_beat()

    def _do_beat(self) -> None:
        """Say what is to be said now, and when to speak next."""
        now = time.monotonic()
        if self._velocity is not None and now - self._set_at > self._timeout:
            self._halt(HALT)
        if self._velocity is not None:
            self._send(self._velocity)
            self._measure()
        elif self._repeats:
            self._repeats -= 1
            self._send(self._halting)
        else:
            self._send(_PULSE)
            self._due = now + _PULSE_EVERY
            return
        self._due += self._period
        if self._due <= now:  # more than a beat late: that beat is left out, the others stay where they are
            self._due += self._period * ((now - self._due) // self._period + 1)

    def _halt(self, packets: bytes) -> None:
        """Drop the velocity and say so at the next beats."""
        resting = self._velocity is None
        self._forget()
        self._halting, self._repeats = packets, _REPEATS
        if resting and self._write is not None:
            self._due = time.monotonic() + self._period
            self._changed.notify()

    def _forget(self) -> None:
        self._velocity = self._sent_at = None

    def _send(self, packets: bytes) -> None:
        """Write; a line that fails is detached and its failure kept for the reader."""
        if self._write is None or not packets:
            return
        try:
            self._write(packets)
        except DeviceError as error:
            self.failure, self._write = error, None
            self._forget()

    def _measure(self) -> None:
        now = time.monotonic()
        if self._sent_at is not None:
            self.intervals.append(now - self._sent_at)
        self._sent_at = now
