"""Bounds of the motion: the robot file's, within what the robot can do, in the robot's units."""

from __future__ import annotations

import math
from dataclasses import dataclass

from drivers.pioneer.codec import CommandNumber, Config, encode_command
from drivers.pioneer.models import Parameters
from zavis_bt.types import BaseLimits, Twist2D


@dataclass(frozen=True, slots=True)
class Bounds:
    """What the driver keeps to and tells the robot."""

    forward: int
    """[mm/s]"""
    reverse: int
    """[mm/s]"""
    rotation: int
    """[degree/s]"""
    acceleration: int
    """[mm/s²]"""
    deceleration: int
    rotation_acceleration: int
    """[degree/s²]"""

    def units(self, twist: Twist2D) -> tuple[int, int]:
        """Return VEL [mm/s] and RVEL [degree/s] for a velocity, within the bounds.

        Raises:
            ValueError: It is not a velocity: not finite.
        """
        if not (math.isfinite(twist.linear) and math.isfinite(twist.angular)):
            raise ValueError(f"{twist} is not a velocity")
        velocity = _whole(twist.linear * 1000, -self.reverse, self.forward)
        rotation = _whole(math.degrees(twist.angular), -self.rotation, self.rotation)
        return velocity, rotation

    def commands(self) -> list[bytes]:
        """Return the packets that tell the robot."""
        number = CommandNumber
        return [
            encode_command(number.SETV, max(self.forward, self.reverse)),
            encode_command(number.SETA, self.acceleration),
            encode_command(number.SETA, -self.deceleration),
            encode_command(number.SETRV, self.rotation),
            encode_command(number.SETRA, self.rotation_acceleration),
            encode_command(number.SETRA, -self.rotation_acceleration),
        ]


def bounds_of(limits: BaseLimits, deceleration: float | None, parameters: Parameters, config: Config | None) -> Bounds:
    """Return the bounds for a robot.

    Args:
        limits: Of the robot file.
        deceleration: Of normal braking [m/s²]; the acceleration if None.
        parameters: Of the robot's family; they bound where the robot tells nothing.
        config: What the robot tells; a zero in it is no bound.
    """
    told = config or Config(velocity_top=0, rotation_velocity_top=0, acceleration_top=0, rotation_acceleration_top=0)
    velocity = told.velocity_top or parameters.max_linear * 1000
    rotation = told.rotation_velocity_top or math.degrees(parameters.max_angular)
    change = told.acceleration_top or parameters.max_linear_acceleration * 1000
    rotation_change = told.rotation_acceleration_top or math.degrees(parameters.max_angular_acceleration)
    return Bounds(
        forward=_whole(limits.max_linear * 1000, 1, velocity),
        reverse=_whole(limits.max_reverse * 1000, 0, velocity),
        rotation=_whole(math.degrees(limits.max_angular), 1, rotation),
        acceleration=_whole(limits.linear_acceleration * 1000, 1, change),
        deceleration=_whole((deceleration or limits.linear_acceleration) * 1000, 1, change),
        rotation_acceleration=_whole(math.degrees(limits.angular_acceleration), 1, rotation_change),
    )


def _whole(value: float, lowest: float, highest: float) -> int:
    return round(min(max(value, lowest), highest))
