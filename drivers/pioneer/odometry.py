"""From the robot's wrapping counters to a pose in the map that goes on, whatever happens to the counters."""

from __future__ import annotations

import math
from typing import NamedTuple

from drivers.pioneer.codec import ANGLE_STEPS, Encoders, Sip
from drivers.pioneer.models import Parameters
from zavis_bt.types import Pose2D, Twist2D, wrap_angle

_COUNTS = 0x8000  # counters wrap at 16 bits, in some robots at 15: modulo 15 bits both are the same
_TICKS = 1 << 32
_RADIANS = math.tau / ANGLE_STEPS
_SLACK = 0.2  # a step may be longer than the top speeds allow, for packets arrive unevenly [m]
_ANGULAR_SLACK = 0.5  # [rad]
_PATIENCE = 5  # SIPs of a new connection until no encoder packet is expected any more


class _Counters(NamedTuple):
    x: int
    y: int
    heading: int


class _Mark(NamedTuple):
    """Where the base was when an encoder packet came."""

    encoders: Encoders
    pose: Pose2D
    stamp: float


class Odometry:
    """Adds up the differences from one SIP to the next (protocol section 5, position wrap).

    The first SIP of each connection is its zero, for robots begin anew there. How far the base still moved after the
    last packet of a connection that broke is known from its wheel encoders, which count on while it is switched on.
    """

    def __init__(self, start: Pose2D) -> None:
        """Begin at a pose in the map."""
        self.pose = start
        """In the map."""
        self.jumps = 0
        """How often the counters jumped."""
        self._last: _Counters | None = None
        self._stamp = -math.inf
        self._mark: _Mark | None = None
        self._patience = 0

    @property
    def settled(self) -> bool:
        """Whether the pose is as good as it gets after a new connection."""
        return self._patience == 0

    def resume(self) -> None:
        """Say that the next packets are the first of a new connection."""
        self._last = None
        self._patience = 0 if self._mark is None else _PATIENCE

    def update(self, sip: Sip, stamp: float, parameters: Parameters) -> Pose2D:
        """Take a SIP that arrived at ``stamp`` [s] and return the pose."""
        now, last = _Counters(sip.x, sip.y, sip.heading), self._last
        if last is not None:
            self._step(last, now, parameters, stamp - self._stamp)
            self._patience = max(self._patience - 1, 0)
        self._last, self._stamp = now, stamp
        return self.pose

    def bridge(self, encoders: Encoders, stamp: float, parameters: Parameters, ticks_per_mm: int) -> None:
        """Take an encoder packet that arrived at ``stamp`` [s].

        The first one of a new connection moves the pose by what the wheels did since the last one of the connection
        before, on an arc.
        """
        if self._patience and self._mark is not None:
            self._patience = 0
            moved = _arc(self._mark.encoders, encoders, ticks_per_mm, parameters)
            if encoders != (0, 0) and _is_possible(moved, stamp - self._mark.stamp, parameters):
                self.pose = self._mark.pose @ moved.pose
        self._mark = _Mark(encoders, self.pose, stamp)

    def _step(self, last: _Counters, now: _Counters, parameters: Parameters, elapsed: float) -> None:
        factor = parameters.distance_factor / 1000
        dx, dy = _difference(now.x, last.x, _COUNTS) * factor, _difference(now.y, last.y, _COUNTS) * factor
        turned = _difference(now.heading, last.heading, ANGLE_STEPS) * _RADIANS
        towards = self.pose.yaw - last.heading * _RADIANS  # from the robot's own frame to the map
        if not _is_possible(_Moved(math.hypot(dx, dy), turned), elapsed, parameters):
            self.jumps += 1
            return
        cos, sin = math.cos(towards), math.sin(towards)
        self.pose = Pose2D(
            self.pose.x + cos * dx - sin * dy, self.pose.y + sin * dx + cos * dy, wrap_angle(self.pose.yaw + turned)
        )


class _Moved(NamedTuple):
    """A way on an arc: its length [m] and turn [rad]."""

    way: float
    turn: float

    @property
    def pose(self) -> Pose2D:
        """End of the way, seen from its beginning."""
        half = self.turn / 2
        chord = self.way * (math.sin(half) / half if half else 1.0)
        return Pose2D(chord * math.cos(half), chord * math.sin(half), wrap_angle(self.turn))


def twist_of(sip: Sip, parameters: Parameters) -> Twist2D:
    """Return the measured velocity; the rotation from the wheels where the robot does not tell it."""
    left, right = (value * parameters.velocity_factor for value in (sip.left_velocity, sip.right_velocity))
    if sip.rotational_velocity is not None:
        angular = math.radians(sip.rotational_velocity / 10)
    else:
        angular = (right - left) / 2 * parameters.difference_factor
    return Twist2D((left + right) / 2000, angular)


def _arc(before: Encoders, after: Encoders, ticks_per_mm: int, parameters: Parameters) -> _Moved:
    left = _difference(after.left, before.left, _TICKS) / ticks_per_mm  # [mm]
    right = _difference(after.right, before.right, _TICKS) / ticks_per_mm
    return _Moved((left + right) / 2000, (right - left) / 2 * parameters.difference_factor)


def _is_possible(moved: _Moved, elapsed: float, parameters: Parameters) -> bool:
    """Return whether the robot can have done that in so many seconds."""
    return (
        abs(moved.way) <= parameters.max_linear * elapsed + _SLACK
        and abs(moved.turn) <= parameters.max_angular * elapsed + _ANGULAR_SLACK
    )


def _difference(now: int, last: int, modulus: int) -> int:
    """Return the shorter way round from one value of a wrapping counter to another."""
    return (now - last + modulus // 2) % modulus - modulus // 2
