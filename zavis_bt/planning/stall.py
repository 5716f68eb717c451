"""Noticing that a robot gets nowhere."""

from __future__ import annotations

import math

from zavis_bt.types import Pose2D, Twist2D

_STILL = 2.5  # commanded to move, but not moving, for so long [s]
_MOVED, _TURNED = 0.02, 0.05  # what counts as moving [m], [rad]
_SLOW, _SLOW_TURN = 0.02, 0.08  # commands below this need not move the base [m/s], [rad/s]
_NO_PROGRESS = 8.0  # moving, but coming no nearer, for so long [s]
_NEARER = 0.04  # what counts as nearer [m]
_RADIAN = 0.15  # a radian of heading to go counts as so many metres


class StallWatch:
    """Tells when a robot that should drive stands still, or moves without coming nearer."""

    def __init__(self) -> None:
        self._place: Pose2D | None = None
        self._moved_at = self._nearer_at = 0.0
        self._nearest = math.inf

    def stuck(self, stamp: float, pose: Pose2D, command: Twist2D, remaining: float, heading_error: float) -> bool:
        """Note where the robot is and return whether it is stuck.

        Args:
            stamp: Now [s].
            pose: Where the robot is.
            command: What it was told last.
            remaining: Path still to go [m].
            heading_error: Angle still to turn [rad].
        """
        idle = abs(command.linear) < _SLOW and abs(command.angular) < _SLOW_TURN
        if self._place is None or idle or self._has_moved(self._place, pose):
            self._place, self._moved_at = pose, stamp
        to_go = remaining + _RADIAN * abs(heading_error)
        if to_go < self._nearest - _NEARER:
            self._nearest, self._nearer_at = to_go, stamp
        return stamp - self._moved_at > _STILL or stamp - self._nearer_at > _NO_PROGRESS

    def _has_moved(self, place: Pose2D, pose: Pose2D) -> bool:
        turned = abs(math.remainder(pose.yaw - place.yaw, math.tau))
        return pose.distance(place) > _MOVED or turned > _TURNED
