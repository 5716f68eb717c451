"""What the wheel encoders tell: way and turn of each step, ticks, and the pose since the client's zero."""

from __future__ import annotations

import math

from sim.devices.arcos.model import PioneerModel
from sim.kinematics import Motion, Place
from zavis_bt.types import Pose2D, wrap_angle


class Odometer:
    """Integrates the odometry of the base, as its firmware does."""

    def __init__(self, model: PioneerModel, motion: Motion) -> None:
        """Begin at the base's present odometry pose, with all counters at zero."""
        self.driven = 0.0
        """Way since the step before [m], negative backwards."""
        self.yaw = motion.odometry.yaw
        """Heading in the frame that does not depend on the client's zero [rad]."""
        self._last: Place = motion.odometry
        self._origin = Pose2D(*motion.odometry)
        self._left = self._right = 0.0  # [m]
        self._half_track = 0.001 / model.diff_conv_factor  # [m]
        self._ticks = model.config.ticks_per_mm * 1000  # [1/m]

    def step(self, motion: Motion) -> None:
        """Note the motion since the step before."""
        last, here = self._last, motion.odometry
        turned = wrap_angle(here.yaw - last.yaw)
        middle = last.yaw + turned / 2
        self.driven = (here.x - last.x) * math.cos(middle) + (here.y - last.y) * math.sin(middle)
        self._left += self.driven - turned * self._half_track
        self._right += self.driven + turned * self._half_track
        self._last, self.yaw = here, here.yaw

    def zero(self, motion: Motion) -> None:
        """Let pose and heading begin here (SETO)."""
        self._origin = Pose2D(*motion.odometry)

    def pose_of(self, motion: Motion) -> Pose2D:
        """Return the pose since the last zero."""
        return self._origin.inverse() @ Pose2D(*motion.odometry)

    def heading_of(self, yaw: float) -> float:
        """Return the heading since the last zero for one that does not depend on it [rad]."""
        return wrap_angle(yaw - self._origin.yaw)

    def yaw_of(self, heading: float) -> float:
        """Return what `heading_of` was made from [rad]."""
        return wrap_angle(heading + self._origin.yaw)

    @property
    def ticks(self) -> tuple[int, int]:
        """Encoder ticks of the left and the right wheel since the robot was switched on, as 32-bit counters."""
        return _wrap(round(self._left * self._ticks)), _wrap(round(self._right * self._ticks))


def _wrap(ticks: int) -> int:
    return (ticks + (1 << 31)) % (1 << 32) - (1 << 31)
