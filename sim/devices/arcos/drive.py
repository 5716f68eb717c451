"""What moves the wheels: set-points of translation and rotation, turned into velocities step by step."""

from __future__ import annotations

from drivers.pioneer.codec import Config
from sim.devices.arcos.limits import rotation_of, translation_of
from sim.devices.arcos.odometer import Odometer
from sim.devices.arcos.profile import Ramp, arrive, ramp
from sim.kinematics import Motion
from zavis_bt.types import wrap_angle

_ARRIVED = 0.001  # a MOVE has ended so near its mark, and so slow [m, m/s]


class WheelDrive:
    """Two independent channels: translation follows a speed or covers a distance, rotation a speed or a heading."""

    def __init__(self, config: Config, period: float) -> None:
        """Stand still, within the stored bounds.

        Args:
            config: Stored configuration.
            period: Time between two calls of `step` [s].
        """
        self.translation, self.rotation = translation_of(config), rotation_of(config)
        self.braking = False
        """Whether an emergency stop is in progress."""
        self.setpoint = 0.0
        """Yaw that rotation holds, or else the present one [rad], as `Odometer.yaw`."""
        self._period = period
        self._speed = self._spin = 0.0
        self._remaining: float | None = None
        self._holds_yaw = self._wheels = False

    def set_speed(self, speed: float) -> None:
        """Translate with a speed [m/s] (VEL)."""
        if self._wheels:
            self.set_wheels(0.0, 0.0)
        self._wheels, self._speed, self._remaining = False, speed, None

    def cover(self, distance: float) -> None:
        """Translate by a distance [m], forward if positive (MOVE)."""
        self.set_speed(0.0)
        self._remaining = distance

    def set_spin(self, spin: float) -> None:
        """Turn with a speed [rad/s] (RVEL)."""
        if self._wheels:
            self.set_wheels(0.0, 0.0)
        self._wheels, self._spin, self._holds_yaw = False, spin, False

    def turn_to(self, yaw: float) -> None:
        """Turn to a yaw [rad] the shorter way, and hold it (HEAD)."""
        self.set_spin(0.0)
        self.setpoint, self._holds_yaw = wrap_angle(yaw), True

    def set_wheels(self, speed: float, spin: float) -> None:
        """Follow both speeds [m/s, rad/s] until either channel is told something else (VEL2)."""
        self._wheels, self._remaining, self._holds_yaw = True, None, False
        self._speed, self._spin = speed, spin

    def stop(self) -> None:
        """Slow down to rest (STOP)."""
        self.set_wheels(0.0, 0.0)

    def brake(self) -> None:
        """Come to rest as fast as the motors can (E_STOP)."""
        self.stop()
        self.braking = True

    def step(self, motion: Motion, odometer: Odometer) -> tuple[Ramp, Ramp]:
        """Return what translation and rotation approach in the next step.

        Args:
            motion: Present velocities.
            odometer: What was driven in the step before.
        """
        if self._remaining is not None:
            self._remaining -= odometer.driven
        if not self._holds_yaw:
            self.setpoint = odometer.yaw
        if self.braking:
            self.braking = motion.linear != 0.0 or motion.angular != 0.0
            return Ramp(0.0, self.translation.top_acceleration), Ramp(0.0, self.rotation.top_acceleration)
        return self._translate(motion.linear), self._rotate(motion.angular, odometer.yaw)

    def _translate(self, speed: float) -> Ramp:
        axis = self.translation
        if self._remaining is None:
            return ramp(speed, axis.clip(self._speed), axis)
        if abs(self._remaining) < _ARRIVED and abs(speed) < _ARRIVED:
            self._remaining = None
            return ramp(speed, 0.0, axis)
        return arrive(self._remaining, speed, axis, self._period)

    def _rotate(self, spin: float, yaw: float) -> Ramp:
        axis = self.rotation
        if self._holds_yaw:
            return arrive(wrap_angle(self.setpoint - yaw), spin, axis, self._period)
        return ramp(spin, axis.clip(self._spin), axis)
