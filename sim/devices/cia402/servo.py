"""A drive's shaft in the numbers of its dictionary, within the software limits."""

from __future__ import annotations

import math
from typing import Any

from drivers.pan_tilt.objects import (
    ACCELERATION,
    DECELERATION,
    MAX_ACCELERATION,
    MAX_VELOCITY,
    POSITION_LIMITS,
    PROFILE_VELOCITY,
    QUICK_STOP_DECELERATION,
)
from sim.devices.cia402.axis import Axis

_AT_REST = 0.5  # [units/s]
_REACTION = 0.03  # so early a limit ahead is braked for [s]


class Servo:
    """What the modes of operation move. Positions are the drive's: the shaft's less the drive's zero."""

    def __init__(self, node: Any, axis: Axis, origin: float) -> None:
        """Work with a ``canopen.LocalNode`` and a shaft; ``origin`` is the shaft's position that the drive calls 0."""
        self._node, self.axis, self.origin = node, axis, origin
        self.limited = False
        """Whether the last motion asked for was cut at a software limit."""
        self._arrival = -math.inf

    def value(self, index: int, sub: int = 0) -> int:
        """Return a number of the dictionary."""
        return int(self._node.sdo[index][sub].raw if sub else self._node.sdo[index].raw)

    def at(self, now: float) -> tuple[float, float]:
        """Return position and velocity."""
        position, speed = self.axis.at(now)
        return position - self.origin, speed

    def at_rest(self, now: float) -> bool:
        """Return whether the shaft stands and nothing moves it."""
        return now >= self._arrival and abs(self.axis.at(now)[1]) < _AT_REST

    def go_to(self, now: float, target: float, rate: float = 0.0) -> None:
        """Begin a move at the profile's velocity (or ``rate``) and the lesser of its accelerations."""
        low, high = self.limits
        inside = min(max(target, low), high)
        self.limited = inside != target
        rate = rate or self.value(PROFILE_VELOCITY)
        self._move(now, inside, min(rate, self.value(MAX_VELOCITY)), self.acceleration)

    def run(self, now: float, speed: float, acceleration: float, hold: float = math.inf) -> None:
        """Approach a velocity; brake after ``hold`` seconds."""
        rate = float(self.value(MAX_VELOCITY))
        speed = min(max(speed, -rate), rate)
        position, _ = self.at(now)
        low, high = self.limits
        self.limited = (speed > 0 and position >= high) or (speed < 0 and position <= low)
        self._arrival = -math.inf
        self.axis.run(now, 0.0 if self.limited else speed, max(acceleration, 1.0), hold)

    def brake(self, now: float, deceleration: float) -> None:
        """Come to rest."""
        self._arrival = -math.inf
        self.axis.run(now, 0.0, max(deceleration, 1.0))

    def quick_stop(self, now: float) -> None:
        """Come to rest at the quick stop's deceleration."""
        self.brake(now, self.value(QUICK_STOP_DECELERATION))

    def keep_limits(self, now: float) -> None:
        """Brake a motion at a velocity that would leave the limits; to be called often."""
        position, speed = self.at(now)
        limit = self.limits[speed > 0]
        if now < self._arrival or abs(speed) < _AT_REST or not math.isfinite(limit):
            return
        braking = max(self.acceleration, self.value(MAX_ACCELERATION))
        if abs(limit - position) <= speed * speed / (2 * braking) + abs(speed) * _REACTION:
            self._move(now, limit, abs(speed), braking)
            self.limited = True

    @property
    def acceleration(self) -> float:
        """The lesser of the profile's acceleration and deceleration, at least 1."""
        return float(max(min(self.value(ACCELERATION), self.value(DECELERATION)), 1))

    @property
    def limits(self) -> tuple[float, float]:
        """Software limits; infinite if the dictionary has none."""
        low, high = self.value(POSITION_LIMITS, 1), self.value(POSITION_LIMITS, 2)
        return (float(low), float(high)) if low < high else (-math.inf, math.inf)

    def _move(self, now: float, target: float, rate: float, acceleration: float) -> None:
        move = self.axis.go_to(now, target + self.origin, max(rate, 1.0), acceleration)
        self._arrival = now + move.duration
