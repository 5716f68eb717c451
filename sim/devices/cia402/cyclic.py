"""Modes of operation with set-points from the master, one each SYNC."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

from drivers.pan_tilt.objects import (
    ACKNOWLEDGED,
    CYCLE_TIME,
    MAX_ACCELERATION,
    MAX_VELOCITY,
    TARGET_POSITION,
    TARGET_VELOCITY,
)
from sim.devices.cia402.modes import NoMode
from sim.devices.cia402.servo import Servo


class _Cyclic(NoMode, ABC):
    def __init__(self, servo: Servo) -> None:
        super().__init__(servo)
        self._written: float | None = None

    @property
    def period(self) -> float:
        """Time between two set-points [s]."""
        value, power = self._servo.value(CYCLE_TIME, 1), self._servo.value(CYCLE_TIME, 2)
        return max(value * 10.0**power, 1e-3)

    def target(self, now: float) -> None:
        """Remember that there is a set-point, for a master that sends no SYNC."""
        if self._written is None:
            self._written = now

    def sync(self, now: float) -> None:
        """Follow the set-point of this cycle."""
        self._written = None
        self.follow(now)

    def tick(self, now: float) -> None:
        """Follow a set-point that no SYNC has come for, and keep to the limits."""
        if self._written is not None and now - self._written > self.period:
            self.sync(now)
        self._servo.keep_limits(now)

    def status(self, now: float) -> int:
        """Return that the drive follows."""
        return ACKNOWLEDGED

    @abstractmethod
    def follow(self, now: float) -> None:
        """Take the set-point in the dictionary."""


class CyclicPosition(_Cyclic):
    """Interpolates between positions: each is reached when the next one is due."""

    def __init__(self, servo: Servo) -> None:
        super().__init__(servo)
        self._last: float | None = None

    def follow(self, now: float) -> None:
        """Run so as to be at the set-point in a cycle's time, as far as velocity and acceleration allow.

        The velocity is the set-points' own, and a share that makes up for what the shaft lags behind; that share is
        no larger than can be braked within the lag.
        """
        low, high = self._servo.limits
        asked = float(self._servo.value(TARGET_POSITION))
        target = min(max(asked, low), high)
        position, _ = self._servo.at(now)
        last = position if self._last is None else self._last
        self._last = target
        period, acceleration = self.period, float(max(self._servo.value(MAX_ACCELERATION), 1))
        rate = float(self._servo.value(MAX_VELOCITY))
        lag = last - position
        feed = min(max((target - last) / period, -rate), rate)
        catching_up = math.copysign(min(abs(lag) / period, math.sqrt(acceleration * abs(lag))), lag)
        self._servo.run(now, feed + catching_up, acceleration, hold=period)
        self._servo.limited = asked != target


class CyclicVelocity(_Cyclic):
    """Runs at the velocity of the latest set-point."""

    def follow(self, now: float) -> None:
        """Approach it at the greatest acceleration."""
        self._servo.run(now, float(self._servo.value(TARGET_VELOCITY)), self._servo.value(MAX_ACCELERATION))
