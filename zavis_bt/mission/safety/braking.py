"""The braking rule: whatever the base is told, it must be able to halt before it meets what the LiDAR sees."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from zavis_bt.mission.safety.settings import SafetySettings
from zavis_bt.planning.stopping import Course, Outline, Velocity, points_near, stays_free, without_own_parts
from zavis_bt.types import BaseState, FloatArray, LaserScan, Pose2D, RobotSpec, Twist2D, wrap_angle

_HALVINGS = 6  # finds the share of a twist that is free to a sixty-fourth
_BEHIND = 0.35  # so far to both sides of straight back the LiDAR must look to see behind [rad]
_STILL = 1e-3  # [m/s]


class Verdict(NamedTuple):
    """What is left of a twist."""

    twist: Twist2D
    reason: str = ""
    """Why it is less than what was asked for; empty if it is not."""
    hard: bool = False
    """Whether the base has to stop as fast as it can."""


class BrakingRule:
    """Allows a twist if the base, told it now and to halt a tick later, stays clear of the scan's points.

    Whenever that held a tick ago, halting now keeps clear too, so there is always a safe way to go on.
    """

    def __init__(self, spec: RobotSpec, settings: SafetySettings) -> None:
        """Take the outline, the limits and the LiDAR's mount."""
        limits = spec.limits
        self._spec, self._settings = spec, settings
        self._whole, self._outline = Outline.of(spec.footprint), Outline.of(spec.footprint, settings.tolerance)
        self._speeding = Velocity(limits.linear_acceleration, limits.angular_acceleration)
        self._slowing = Velocity(
            settings.deceleration or limits.linear_acceleration,
            settings.turn_deceleration or limits.angular_acceleration,
        )
        lidar = spec.lidar
        off = abs(wrap_angle(math.pi - lidar.mount.yaw))
        self._sees_behind = lidar.field_of_view >= math.tau - 1e-6 or off + _BEHIND <= lidar.field_of_view / 2

    def limit(
        self, asked: Twist2D, state: BaseState, points: FloatArray, before: Twist2D, delay: float, reaction: float
    ) -> Verdict:
        """Return what of a twist is safe.

        Args:
            asked: What a behaviour asks for.
            state: The base.
            points: (n, 2) obstacles in the base frame at the time of the state [m], from `points`.
            before: What the base was told last.
            delay: Age of the state [s].
            reaction: Time until the base can be told otherwise [s].
        """
        asked = self._within_limits(asked)

        def free(linear: float, angular: float, extra: float) -> bool:
            told = Velocity(float(linear), float(angular))
            ramp = self._course(state.twist, before, told, delay, reaction, extra)
            jump = ramp._replace(now=told, before=told)  # there sooner than its limits say
            give = self._settings.margin
            return stays_free(points, self._outline, ramp, give) and stays_free(points, self._outline, jump, give)

        extra = self._settings.margin + self._settings.tolerance
        if free(asked.linear, asked.angular, extra):
            return Verdict(asked)
        reason = _obstacle(asked)
        if free(0.0, asked.angular, extra):
            share = _largest(lambda share: free(share * asked.linear, asked.angular, extra))
            return Verdict(Twist2D(share * asked.linear, asked.angular), reason)
        if free(0.0, 0.0, 0.0):
            share = _largest(lambda share: free(share * asked.linear, share * asked.angular, extra))
            return Verdict(Twist2D(share * asked.linear, share * asked.angular), reason)
        return Verdict(Twist2D(), reason, hard=True)

    def points(self, scan: LaserScan, seen_from: Pose2D, state: BaseState) -> FloatArray:
        """Return the (n, 2) points of a scan that the base could meet, in the base frame at the state's time [m].

        Args:
            scan: Latest scan.
            seen_from: The base's pose when it was taken.
            state: The base now.
        """
        sensor = self._spec.lidar.mount
        if seen_from != state.pose:
            sensor = state.pose.inverse() @ seen_from @ sensor
        points = points_near(
            scan.ranges,
            scan.angle_min,
            scan.angle_increment,
            scan.range_min,
            (sensor.x, sensor.y, sensor.yaw),
            self._reach(state.twist),
        )
        return without_own_parts(points, self._whole)

    def _reach(self, twist: Twist2D) -> float:
        limits, settings = self._spec.limits, self._settings
        fastest = Velocity(max(limits.max_linear, limits.max_reverse, abs(twist.linear)), 0.0)
        extra = settings.margin + settings.tolerance
        late = settings.base_timeout, settings.tick_limit
        course = Course(fastest, fastest, late[0], fastest, late[1], self._speeding, self._slowing, extra)
        return course.length + self._whole.reach

    def _within_limits(self, twist: Twist2D) -> Twist2D:
        limits = self._spec.limits
        backwards = limits.max_reverse if self._sees_behind else min(limits.max_reverse, self._settings.creep)
        return Twist2D(
            min(max(twist.linear, -backwards), limits.max_linear),
            min(max(twist.angular, -limits.max_angular), limits.max_angular),
        )

    def _course(
        self, now: Twist2D, before: Twist2D, asked: Velocity, delay: float, reaction: float, extra: float
    ) -> Course:
        return Course(
            Velocity(float(now.linear), float(now.angular)),
            Velocity(float(before.linear), float(before.angular)),
            delay,
            asked,
            reaction,
            self._speeding,
            self._slowing,
            extra,
        )


def _largest(free: Callable[[float], bool]) -> float:
    """Return a share below 1 that is free, near the largest one; 0 if none was found."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if free(middle) else (low, middle)
    return low


def _obstacle(asked: Twist2D) -> str:
    if abs(asked.linear) < _STILL:
        return "no room to turn"
    return "obstacle ahead" if asked.linear > 0 else "obstacle behind"
