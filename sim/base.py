"""The simulated mobile base."""

from __future__ import annotations

import math

from sim.physics import Physics
from zavis_bt.types import BaseLimits, BaseState, Pose2D, Twist2D

_GRIP = 3.0  # how hard tyres can brake on a floor [m/s²]
_SPIN_GRIP = 10.0  # [rad/s²]


class SimBase:
    """A differential-drive base with watchdog, bumper, stall detection and emergency stop."""

    def __init__(self, physics: Physics, limits: BaseLimits, *, watchdog: float) -> None:
        """Connect to the base of a world; after ``watchdog`` seconds without a command it slows down to rest."""
        self._physics, self._limits, self._watchdog = physics, limits, watchdog
        self._battery = 1.0
        self._estop = False

    def state(self) -> BaseState:
        """Return pose by odometry, velocity and switches as they are now."""
        motion = self._physics.motion
        return BaseState(
            pose=Pose2D(*motion.odometry),
            twist=Twist2D(motion.linear, motion.angular),
            stamp=self._physics.now,
            battery=self._battery,
            bumper=motion.contact.touching,
            stalled=motion.contact.stalled,
            estop=self._estop,
        )

    def pose_at(self, stamp: float) -> Pose2D:
        """Return the pose by odometry at a time within the simulation's memory [s]."""
        return self._physics.poses_at(self._physics.step_at(stamp))[1]

    def command(self, twist: Twist2D) -> None:
        """Drive with this velocity, clipped to the limits; ignored while the emergency stop is pressed.

        Raises:
            ValueError: The velocity is not finite.
        """
        if not (math.isfinite(twist.linear) and math.isfinite(twist.angular)):
            raise ValueError(f"{twist} is not a velocity")
        if not self._estop:
            self._physics.command(twist.linear, twist.angular, self._limits, self._watchdog)

    def stop(self) -> None:
        """Come to rest as fast as the wheels grip."""
        limits = self._limits
        linear, angular = max(_GRIP, limits.linear_acceleration), max(_SPIN_GRIP, limits.angular_acceleration)
        self._physics.drive(0.0, 0.0, linear, angular)

    def press_estop(self, pressed: bool = True) -> None:
        """Press or release the emergency stop, as a person standing by would."""
        self._estop = pressed
        self.stop()

    def set_battery(self, charge: float) -> None:
        """Set the state of charge, 0 to 1; it does not change by itself."""
        self._battery = min(max(charge, 0.0), 1.0)
