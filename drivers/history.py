"""What a device measured in the last seconds, to be asked for any moment of them."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import deque

from zavis_bt.types import Pose2D, Twist2D, wrap_angle

_AHEAD = 0.3  # so far beyond the latest measurement motion is taken to go on as it was [s]


class PoseHistory:
    """Poses of the base with their times. One thread adds, any may ask."""

    def __init__(self, seconds: float = 3.0) -> None:
        """Remember ``seconds`` [s] of poses."""
        self._seconds = seconds
        self._entries: deque[tuple[float, Pose2D, Twist2D]] = deque()

    def add(self, stamp: float, pose: Pose2D, twist: Twist2D) -> None:
        """Note where the base was at ``stamp`` [s], later than before, and how it moved."""
        self._entries.append((stamp, pose, twist))
        while self._entries[0][0] < stamp - self._seconds:
            self._entries.popleft()

    def at(self, stamp: float) -> Pose2D:
        """Return the pose at ``stamp`` [s]: between two measurements on the line, soon after the last one by its twist.

        Before the first measurement that is known it is the first; without any it is the origin.
        """
        entries = tuple(self._entries)
        if not entries:
            return Pose2D(0.0, 0.0)
        index = bisect_right(entries, stamp, key=lambda entry: entry[0])
        if index == 0:
            return entries[0][1]
        before, pose, twist = entries[index - 1]
        if index == len(entries):
            return _moved(pose, twist, min(stamp - before, _AHEAD))
        after, towards, _ = entries[index]
        share = (stamp - before) / (after - before)
        turned = wrap_angle(towards.yaw - pose.yaw)
        return Pose2D(
            pose.x + share * (towards.x - pose.x),
            pose.y + share * (towards.y - pose.y),
            wrap_angle(pose.yaw + share * turned),
        )


def _moved(pose: Pose2D, twist: Twist2D, seconds: float) -> Pose2D:
    heading = pose.yaw + twist.angular * seconds / 2
    way = twist.linear * seconds
    return Pose2D(
        pose.x + way * math.cos(heading),
        pose.y + way * math.sin(heading),
        wrap_angle(pose.yaw + twist.angular * seconds),
    )
