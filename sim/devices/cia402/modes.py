"""Modes of operation with the drive's own profiles: positions and velocities."""

from __future__ import annotations

from typing import Protocol

from drivers.pan_tilt.objects import (
    ACCELERATION,
    ACKNOWLEDGED,
    AT_ONCE,
    DECELERATION,
    HALT,
    NEW_SET_POINT,
    RELATIVE,
    TARGET_POSITION,
    TARGET_REACHED,
    TARGET_VELOCITY,
)
from sim.devices.cia402.servo import Servo

_SAME = 1.0  # [units/s]


class Operation(Protocol):
    """What a mode does while the drive is in operation."""

    def control(self, now: float, word: int, before: int) -> None:
        """Take a controlword, and the one before it."""

    def target(self, now: float) -> None:
        """A target has been written."""

    def sync(self, now: float) -> None:
        """A SYNC has come, and what waited for it is in the dictionary."""

    def tick(self, now: float) -> None:
        """Time has passed."""

    def status(self, now: float) -> int:
        """Return the mode's bits of the statusword."""


class NoMode:
    """The drive stands."""

    def __init__(self, servo: Servo) -> None:
        self._servo = servo

    def control(self, now: float, word: int, before: int) -> None:
        """Nothing to do."""

    def target(self, now: float) -> None:
        """Nothing to do."""

    def sync(self, now: float) -> None:
        """Nothing to do."""

    def tick(self, now: float) -> None:
        """Nothing to do."""

    def status(self, now: float) -> int:
        """Return no bits."""
        return 0


class ProfilePosition(NoMode):
    """Moves to targets, each begun by a rising edge of the new set-point's bit."""

    def __init__(self, servo: Servo) -> None:
        super().__init__(servo)
        self._acknowledged = False
        self._asked = False  # whether the master's new set-point bit is set
        self._halted = False
        self._target: float | None = None
        self._next: float | None = None

    def control(self, now: float, word: int, before: int) -> None:
        """Take a new set-point, halt, or go on after a halt."""
        if word & HALT and not self._halted:
            self._servo.brake(now, self._servo.value(DECELERATION))
        resumed = self._halted and not word & HALT
        self._halted = bool(word & HALT)
        self._asked = bool(word & NEW_SET_POINT)
        if word & ~before & NEW_SET_POINT and not self._acknowledged:
            self._accept(now, word)
        elif resumed and self._target is not None:
            self._servo.go_to(now, self._target)
        if not self._asked and self._next is None:
            self._acknowledged = False

    def tick(self, now: float) -> None:
        """Begin the set-point that waits for the end of the move before.

        It stays acknowledged until the master takes its bit back, or the master might never see it.
        """
        if self._halted or self._next is None or not self._servo.at_rest(now):
            return
        self._begin(now, self._next)
        self._next = None
        self._acknowledged = self._asked

    def status(self, now: float) -> int:
        """Return target reached (at rest, when halted) and set-point acknowledged."""
        reached = self._servo.at_rest(now) and self._next is None
        return reached * TARGET_REACHED | self._acknowledged * ACKNOWLEDGED

    def _accept(self, now: float, word: int) -> None:
        self._acknowledged = True
        target = float(self._servo.value(TARGET_POSITION))
        if word & RELATIVE:
            # Relative to the target before, as long as that is what the drive goes for; else to where it stands.
            target += self._servo.at(now)[0] if self._target is None else self._target
        if word & AT_ONCE or self._servo.at_rest(now):
            self._next = None
            self._begin(now, target)
        else:
            self._next = target

    def _begin(self, now: float, target: float) -> None:
        self._target = target
        if not self._halted:
            self._servo.go_to(now, target)


class ProfileVelocity(NoMode):
    """Runs at the target velocity."""

    def __init__(self, servo: Servo) -> None:
        super().__init__(servo)
        self._halted = False
        self._wanted = 0.0

    def control(self, now: float, word: int, before: int) -> None:
        """Halt, or go on."""
        self._halted = bool(word & HALT)
        self.target(now)

    def target(self, now: float) -> None:
        """Approach the velocity that is wanted now, if it is another one."""
        wanted = 0.0 if self._halted else float(self._servo.value(TARGET_VELOCITY))
        if wanted != self._wanted:
            faster = abs(wanted) > abs(self._servo.at(now)[1])
            self._servo.run(now, wanted, self._servo.value(ACCELERATION if faster else DECELERATION))
            self._wanted = wanted

    def tick(self, now: float) -> None:
        """Keep to the limits."""
        self._servo.keep_limits(now)

    def status(self, now: float) -> int:
        """Return target reached and speed zero."""
        speed = self._servo.at(now)[1]
        reached = abs(speed - self._wanted) < _SAME
        return reached * TARGET_REACHED | (abs(speed) < _SAME) * ACKNOWLEDGED
