"""Bounds of the motion that the client may change while it is connected."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drivers.pioneer.codec import Config


@dataclass(slots=True)
class Axis:
    """Bounds of translation [m/s, m/s²] or rotation [rad/s, rad/s²]."""

    speed: float
    acceleration: float
    deceleration: float
    top_speed: float
    """Absolute bound of the speed."""
    top_acceleration: float
    """Absolute bound of the acceleration; an emergency stop uses all of it."""
    unit: float
    """Of the protocol's integers: 1 mm/s or 1 degree/s."""

    def set_speed(self, value: int) -> None:
        """Bound the speed (SETV, SETRV), at most by the absolute bound [units]."""
        self.speed = min(abs(value) * self.unit, self.top_speed)

    def set_acceleration(self, value: int) -> None:
        """Bound the acceleration if positive, the deceleration if negative (SETA, SETRA); zero changes nothing."""
        magnitude = min(abs(value) * self.unit, self.top_acceleration)
        if value > 0:
            self.acceleration = magnitude
        elif value < 0:
            self.deceleration = magnitude

    def clip(self, speed: float) -> float:
        """Return the speed within the bound."""
        return min(max(speed, -self.speed), self.speed)

    @property
    def figures(self) -> tuple[int, int, int]:
        """Speed, acceleration and deceleration [units]."""
        speed, acceleration, deceleration = (
            round(value / self.unit) for value in (self.speed, self.acceleration, self.deceleration)
        )
        return speed, acceleration, deceleration


def translation_of(config: Config) -> Axis:
    """Return the stored bounds of translation."""
    figures = config.velocity_max, config.acceleration, config.deceleration
    return _axis(0.001, *figures, config.velocity_top, config.acceleration_top)


def rotation_of(config: Config) -> Axis:
    """Return the stored bounds of rotation."""
    figures = config.rotation_velocity_max, config.rotation_acceleration, config.rotation_deceleration
    return _axis(math.pi / 180, *figures, config.rotation_velocity_top, config.rotation_acceleration_top)


def _axis(unit: float, *figures: int) -> Axis:
    speed, acceleration, deceleration, top_speed, top_acceleration = (figure * unit for figure in figures)
    return Axis(speed, acceleration, deceleration, top_speed, top_acceleration, unit)
