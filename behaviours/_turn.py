"""Turning on the spot."""

from __future__ import annotations

import math

from zavis_bt.protocols import Robot
from zavis_bt.types import Twist2D, wrap_angle

_GAIN = 1.8  # [1/s]
_SLOWEST = 0.15  # below this the wheels of a skid-steer base stick [rad/s]


class Turn:
    """Brings the base to a heading, turning on the spot, with room to brake."""

    def __init__(self, robot: Robot, heading: float, tolerance: float = 0.05) -> None:
        """Set the goal.

        Args:
            robot: Whose base.
            heading: Yaw in the map [rad].
            tolerance: Accepted error [rad].
        """
        self._robot, self._heading, self._tolerance = robot, heading, tolerance

    def update(self) -> bool:
        """Command this tick's turn rate; return whether the heading is reached."""
        error = wrap_angle(self._heading - self._robot.base.state().pose.yaw)
        if abs(error) <= self._tolerance:
            self._robot.base.command(Twist2D())
            return True
        limits = self._robot.spec.limits
        braking = math.sqrt(2 * limits.angular_acceleration * abs(error)) * 0.7
        rate = max(min(_GAIN * abs(error), limits.max_angular, braking), _SLOWEST)
        self._robot.base.command(Twist2D(0.0, math.copysign(rate, error)))
        return False
