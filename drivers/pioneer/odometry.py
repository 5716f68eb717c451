"""From the robot's wrapping counters to a pose in the map that goes on, whatever happens to the counters."""

from __future__ import annotations

import math
from typing import NamedTuple

from drivers.pioneer.codec import ANGLE_STEPS, Sip
from drivers.pioneer.models import Parameters
from zavis_bt.types import Pose2D, Twist2D, wrap_angle

_COUNTS = 0x8000  # counters wrap at 16 bits, in some robots at 15: modulo 15 bits both are the same
_RADIANS = math.tau / ANGLE_STEPS
_SLACK = 0.2  # a step may be longer than the top speeds allow, for packets arrive unevenly [m]
_ANGULAR_SLACK = 0.5  # [rad]
_LONGEST_ABSENCE = 3.0  # whoever was away for longer could be anywhere [s]


class _Counters(NamedTuple):
    x: int
    y: int
    heading: int


class Odometry:
    """Adds up the differences from one SIP to the next (protocol section 5, position wrap).

    The first SIP is the zero. A robot that was away and has kept its counters meanwhile is where they say; one that has
    zeroed them, or whose counters jumped further than it can drive, is taken to stand where it was last.
    """

    def __init__(self, start: Pose2D) -> None:
        """Begin at a pose in the map."""
        self.pose = start
        """In the map."""
        self.jumps = 0
        """How often the counters jumped."""
        self._last: _Counters | None = None
        self._stamp = -math.inf
        self._resumed = False

    def resume(self) -> None:
        """Say that the next SIP is the first of a new connection."""
        self._resumed = True

    def update(self, sip: Sip, stamp: float, parameters: Parameters) -> Pose2D:
        """Take a SIP that arrived at ``stamp`` [s] and return the pose."""
        now, last = _Counters(sip.x, sip.y, sip.heading), self._last
        if last is not None:
            elapsed = min(stamp - self._stamp, _LONGEST_ABSENCE)
            self._step(last, now, parameters, elapsed)
        self._last, self._stamp, self._resumed = now, stamp, False
        return self.pose

    def _step(self, last: _Counters, now: _Counters, parameters: Parameters, elapsed: float) -> None:
        if self._resumed and now == (0, 0, 0):
            return
        factor = parameters.distance_factor / 1000
        dx, dy = _difference(now.x, last.x, _COUNTS) * factor, _difference(now.y, last.y, _COUNTS) * factor
        turned = _difference(now.heading, last.heading, ANGLE_STEPS) * _RADIANS
        too_far = math.hypot(dx, dy) > parameters.max_linear * elapsed + _SLACK
        if too_far or abs(turned) > parameters.max_angular * elapsed + _ANGULAR_SLACK:
            self.jumps += 1
            return
        towards = self.pose.yaw - last.heading * _RADIANS  # from the robot's own frame to the map
        cos, sin = math.cos(towards), math.sin(towards)
        self.pose = Pose2D(
            self.pose.x + cos * dx - sin * dy, self.pose.y + sin * dx + cos * dy, wrap_angle(self.pose.yaw + turned)
        )


def twist_of(sip: Sip, parameters: Parameters) -> Twist2D:
    """Return the measured velocity; the rotation from the wheels where the robot does not tell it."""
    left, right = (value * parameters.velocity_factor for value in (sip.left_velocity, sip.right_velocity))
    if sip.rotational_velocity is not None:
        angular = math.radians(sip.rotational_velocity / 10)
    else:
        angular = (right - left) / 2 * parameters.difference_factor
    return Twist2D((left + right) / 2000, angular)


def _difference(now: int, last: int, modulus: int) -> int:
    """Return the shorter way round from one value of a wrapping counter to another."""
    return (now - last + modulus // 2) % modulus - modulus // 2
