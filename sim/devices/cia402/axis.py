"""The moving part of a drive: rate- and acceleration-limited motion as a function of time."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple, Protocol

from sim.trapezoid import Trapezoid, fastest

_MEMORY = 3.0  # [s]


class Profile(Protocol):
    """A motion since its start."""

    def at(self, time: float) -> tuple[float, float]:
        """Return position and velocity at a time since the start."""


class Ramp(NamedTuple):
    """Approach a velocity, hold it for a while, then brake to rest."""

    start: float
    speed: float
    target_speed: float
    acceleration: float
    """Positive."""
    hold: float = math.inf
    """Time from the start to the braking."""

    def at(self, time: float) -> tuple[float, float]:
        """Return position and velocity at a time since the start [s]."""
        if time <= self.hold:
            return _ramped(self.start, self.speed, self.target_speed, self.acceleration, time)
        begin = _ramped(self.start, self.speed, self.target_speed, self.acceleration, self.hold)
        return _ramped(*begin, 0.0, self.acceleration, time - self.hold)


def _ramped(start: float, speed: float, target: float, acceleration: float, time: float) -> tuple[float, float]:
    change = min(abs(target - speed), acceleration * time)
    reached = speed + math.copysign(change, target - speed)
    spent = change / acceleration
    return start + (speed + reached) / 2 * spent + reached * (time - spent), reached


class Axis:
    """A shaft between two hard stops. Positions are counted from the mechanical zero, in the drive's units."""

    def __init__(self, low: float, high: float, position: float) -> None:
        """Put it at rest at ``position``; ``low`` and ``high`` are the hard stops."""
        self._low, self._high = low, high
        self._segments: deque[tuple[float, Profile]] = deque([(-math.inf, Ramp(position, 0.0, 0.0, 1.0))])

    def at(self, time: float) -> tuple[float, float]:
        """Return position and velocity at a time within the last seconds."""
        segment = next((segment for segment in reversed(self._segments) if segment[0] <= time), self._segments[0])
        begun, profile = segment
        position, speed = profile.at(time - begun if math.isfinite(begun) else 0.0)
        stopped = min(max(position, self._low), self._high)
        return stopped, speed if stopped == position else 0.0

    def go_to(self, now: float, target: float, rate: float, acceleration: float) -> Trapezoid:
        """Begin the fastest move to rest at ``target``; return it."""
        position, speed = self.at(now)
        move = fastest(position, speed, target, max(rate, abs(speed)), acceleration)
        self._begin(now, move)
        return move

    def run(self, now: float, speed: float, acceleration: float, hold: float = math.inf) -> None:
        """Approach a velocity; brake after ``hold`` seconds."""
        position, current = self.at(now)
        self._begin(now, Ramp(position, current, speed, acceleration, hold))

    def _begin(self, now: float, profile: Profile) -> None:
        self._segments.append((now, profile))
        while self._segments[1][0] < now - _MEMORY:
            self._segments.popleft()
