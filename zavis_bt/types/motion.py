"""Poses, velocities, paths and what the moving parts say of themselves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def wrap_angle(angle: float) -> float:
    """Return the angle in (−π, π] [rad]."""
    wrapped = math.remainder(angle, math.tau)
    return math.pi if wrapped == -math.pi else wrapped


@dataclass(frozen=True, slots=True)
class Pose2D:
    """A pose in the plane, x and y [m], yaw [rad]. ``a @ b`` is b, given in frame a, seen from a's parent frame."""

    x: float
    y: float
    yaw: float = 0.0

    def __matmul__(self, other: Pose2D) -> Pose2D:
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(
            self.x + cos * other.x - sin * other.y,
            self.y + sin * other.x + cos * other.y,
            wrap_angle(self.yaw + other.yaw),
        )

    def inverse(self) -> Pose2D:
        """Return the pose of the parent frame in this frame."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(-cos * self.x - sin * self.y, sin * self.x - cos * self.y, wrap_angle(-self.yaw))

    def distance(self, other: Pose2D) -> float:
        """Return the straight distance between the two positions [m]."""
        return math.hypot(other.x - self.x, other.y - self.y)

    def bearing(self, x: float, y: float) -> float:
        """Return the angle from this pose's heading to the point (x, y) of the parent frame [rad]."""
        return wrap_angle(math.atan2(y - self.y, x - self.x) - self.yaw)


@dataclass(frozen=True, slots=True)
class Twist2D:
    """A differential drive's velocity: forward [m/s], counter-clockwise [rad/s]."""

    linear: float = 0.0
    angular: float = 0.0


@dataclass(frozen=True, slots=True)
class Path:
    """A polyline in the map frame."""

    points: FloatArray
    """(n, 2) [m], from start to goal."""

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum()) if len(self.points) > 1 else 0.0


@dataclass(frozen=True, slots=True)
class BaseState:
    """What the mobile base says of itself."""

    pose: Pose2D
    """Odometry pose in the map frame."""
    twist: Twist2D
    """Measured velocity."""
    stamp: float
    """Time of the measurement on the mission's clock [s]."""
    battery: float = 1.0
    """State of charge, 0 to 1."""
    bumper: bool = False
    """Whether any bumper is pressed."""
    stalled: bool = False
    """Whether a wheel is held fast."""
    estop: bool = False
    """Whether the emergency stop is pressed."""
    fault: str = ""
    """Why the base cannot drive now, in plain words with the remedy; empty if it can."""


@dataclass(frozen=True, slots=True)
class PanTiltState:
    """Joint angles of the pan-tilt unit [rad]; pan counter-clockwise, tilt up; ``settled`` at the commanded target."""

    pan: float
    tilt: float
    settled: bool
    stamp: float
    """Time of the measurement on the mission's clock [s]."""
    fault: str = ""
    """Why the unit cannot move now, in plain words with the remedy; empty if it can."""
