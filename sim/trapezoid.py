"""Fastest motion of one axis to rest at a target, within a rate and an acceleration."""

from __future__ import annotations

import math
from typing import NamedTuple


class Trapezoid(NamedTuple):
    """Speed up, cruise, slow down; a function of the time since its start."""

    start: float
    """Position at time 0."""
    speed: float
    """Velocity at time 0."""
    acceleration: float
    """Of the first phase, signed; the last phase has its negative."""
    cruise: float
    """Velocity between the phases."""
    durations: tuple[float, float, float]
    """Of the three phases [s]."""
    target: float

    @property
    def duration(self) -> float:
        """Time to rest at the target [s]."""
        return sum(self.durations)

    def at(self, time: float) -> tuple[float, float]:
        """Return position and velocity at a time since the start [s]."""
        speeding, _, slowing = self.durations
        if time >= self.duration:
            return self.target, 0.0
        if time < speeding:
            return self.start + (
                self.speed + self.acceleration * time / 2
            ) * time, self.speed + self.acceleration * time
        left = self.duration - time
        if left < slowing:
            return self.target - self.acceleration * left * left / 2, self.acceleration * left
        ahead = (self.speed + self.cruise) / 2 * speeding
        return self.start + ahead + self.cruise * (time - speeding), self.cruise


def fastest(start: float, speed: float, target: float, max_rate: float, max_acceleration: float) -> Trapezoid:
    """Return the time-optimal motion from a position and velocity to rest at the target.

    Args:
        start: Position.
        speed: Velocity, at most ``max_rate`` either way.
        target: Where to come to rest.
        max_rate: Bound of the velocity, positive.
        max_acceleration: Bound of the acceleration, positive.
    """
    rest = start + speed * abs(speed) / (2 * max_acceleration)  # where braking at once would end
    sign = math.copysign(1.0, target - rest)
    initial, distance = sign * speed, sign * (target - start)
    peak = math.sqrt(max(max_acceleration * distance + initial * initial / 2, 0.0))
    cruise = max(min(peak, max_rate), initial, 0.0)
    over = distance - (2 * cruise * cruise - initial * initial) / (2 * max_acceleration)
    cruising = max(over, 0.0) / cruise if cruise > 0 else 0.0
    durations = (cruise - initial) / max_acceleration, cruising, cruise / max_acceleration
    return Trapezoid(start, speed, sign * max_acceleration, sign * cruise, durations, target)
