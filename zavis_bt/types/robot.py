"""What a robot is like: outline, limits, sensors and their mounts."""

from __future__ import annotations

import math
from dataclasses import dataclass

from zavis_bt.types.motion import Pose2D
from zavis_bt.types.sensing import CameraIntrinsics


@dataclass(frozen=True, slots=True)
class Footprint:
    """The robot's outline on the floor: a disc, or a rectangle with the base's origin inside it."""

    length: float
    """Along x [m]; a disc's diameter."""
    width: float
    """Along y [m]; a disc's diameter."""
    centre_x: float = 0.0
    """Middle of the rectangle ahead of the base's origin [m]."""
    disc: bool = False

    @property
    def inscribed_radius(self) -> float:
        """Radius of the largest disc about the origin inside the outline [m]."""
        return min(self.length / 2 - abs(self.centre_x), self.width / 2)

    @property
    def circumscribed_radius(self) -> float:
        """Radius of the smallest disc about the origin around the outline [m]."""
        if self.disc:
            return self.length / 2
        return math.hypot(self.length / 2 + abs(self.centre_x), self.width / 2)


@dataclass(frozen=True, slots=True)
class BaseLimits:
    """Bounds of the base's motion, all positive."""

    max_linear: float
    """[m/s]"""
    max_reverse: float
    """[m/s]"""
    max_angular: float
    """[rad/s]"""
    linear_acceleration: float
    """[m/s²]"""
    angular_acceleration: float
    """[rad/s²]"""


@dataclass(frozen=True, slots=True)
class LidarSpec:
    """A planar LiDAR and where it sits on the base."""

    beams: int
    field_of_view: float
    """Angle between the first and the last beam [rad]; beams lie symmetric about the sensor's x axis."""
    range_min: float
    range_max: float
    rate: float
    """Scans a second [Hz]."""
    mount: Pose2D
    """Sensor in the base frame."""
    height: float
    """Above the floor [m]."""

    @property
    def angle_increment(self) -> float:
        """Angle between neighbouring beams [rad]; a full circle does not measure its first direction twice."""
        full = self.field_of_view >= math.tau - 1e-9
        return self.field_of_view / (self.beams if full else self.beams - 1)

    @property
    def angle_min(self) -> float:
        """Direction of the first beam [rad]."""
        return -self.field_of_view / 2


@dataclass(frozen=True, slots=True)
class PanTiltSpec:
    """Limits of the pan-tilt unit, angles [rad], rates [rad/s], accelerations [rad/s²]."""

    pan_min: float
    pan_max: float
    tilt_min: float
    tilt_max: float
    max_rate: float
    max_acceleration: float


@dataclass(frozen=True, slots=True)
class CameraSpec:
    """An RGB-D camera on the pan-tilt unit."""

    intrinsics: CameraIntrinsics
    x: float
    """Pan axis ahead of the base's origin [m]."""
    height: float
    """Optical centre above the floor at zero tilt [m]; pan and tilt axes run through it."""
    depth_min: float
    depth_max: float
    rate: float
    """Frames a second [Hz]."""


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """What a robot is like, whoever plays it: the model part of a robot file."""

    name: str
    footprint: Footprint
    limits: BaseLimits
    lidar: LidarSpec
    pan_tilt: PanTiltSpec
    camera: CameraSpec
