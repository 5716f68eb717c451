"""The moving base in its world, in steps of fixed length."""

from __future__ import annotations

import math

import numpy as np

from sim.collision import Body
from sim.kinematics import Drive, Ground, Motion, OdometryError, advance, at_rest
from zavis_bt.types import BaseLimits, FloatArray, Pose2D

STEPS_PER_SECOND = 50


class Physics:
    """Advances the base step by step and remembers its latest poses."""

    def __init__(
        self,
        ground: Ground,
        body: Body,
        start: Pose2D,
        *,
        error: OdometryError,
        rng: np.random.Generator,
        memory: float,
    ) -> None:
        """Put the base down.

        Args:
            ground: Obstacles.
            body: Outline in cells.
            start: First pose, which must be free.
            error: Of the odometry.
            rng: For the odometry's error.
            memory: How long ago `poses_at` must still know [s].
        """
        self._ground, self._body, self._error, self._rng = ground, body, error, rng
        self.motion: Motion = at_rest(start.x, start.y, start.yaw)
        self.step = 0
        """Steps done so far."""
        self._command = Drive(0.0, 0.0, 0, 0.0, 0.0)
        self._history: FloatArray = np.empty((math.ceil(memory * STEPS_PER_SECOND) + 2, 6))
        self._history[:] = (*self.motion.true, *self.motion.odometry)

    @property
    def now(self) -> float:
        """Simulated time [s]."""
        return self.step / STEPS_PER_SECOND

    def command(self, linear: float, angular: float, limits: BaseLimits, lasting: float) -> None:
        """Drive with a velocity, clipped to the limits, for ``lasting`` seconds; then slow down to rest."""
        self._command = Drive(
            float(min(max(linear, -limits.max_reverse), limits.max_linear)),
            float(min(max(angular, -limits.max_angular), limits.max_angular)),
            self.step + round(lasting * STEPS_PER_SECOND),
            limits.linear_acceleration / STEPS_PER_SECOND,
            limits.angular_acceleration / STEPS_PER_SECOND,
        )

    def drive(self, linear: float, angular: float, linear_change: float, angular_change: float) -> None:
        """Approach a velocity until told otherwise, within accelerations [m/s²], [rad/s²]."""
        forever = np.iinfo(np.int64).max
        changes = linear_change / STEPS_PER_SECOND, angular_change / STEPS_PER_SECOND
        self._command = Drive(linear, angular, int(forever), *changes)

    def advance_to(self, stamp: float) -> None:
        """Advance until ``now >= stamp``."""
        steps = math.ceil(stamp * STEPS_PER_SECOND - 1e-6) - self.step
        if steps <= 0:
            return
        normals = self._rng.standard_normal((steps, 2)) if self._error.any else np.zeros((steps, 2))
        self.motion = advance(
            self.motion,
            self._command,
            self._ground,
            self._body,
            self.step,
            1 / STEPS_PER_SECOND,
            self._history,
            self._error,
            normals,
        )
        self.step += steps

    def step_at(self, stamp: float) -> int:
        """Return the step nearest to a time [s] among those that `poses_at` knows."""
        oldest = max(self.step - len(self._history) + 1, 0)
        return min(max(round(stamp * STEPS_PER_SECOND), oldest), self.step)

    def poses_at(self, step: int) -> tuple[Pose2D, Pose2D]:
        """Return the true pose and the odometry's after ``step`` steps, which must be within the memory."""
        x, y, yaw, odometry_x, odometry_y, odometry_yaw = self._history[step % len(self._history)].tolist()
        return Pose2D(x, y, yaw), Pose2D(odometry_x, odometry_y, odometry_yaw)


class Schedule:
    """When a sensor that works at a fixed rate takes its samples, in steps."""

    def __init__(self, rate: float) -> None:
        """Start at time 0 with ``rate`` samples a second [Hz]."""
        self._steps = STEPS_PER_SECOND / rate

    def latest(self, step: int) -> tuple[int, int]:
        """Return the number of the latest sample and the step it was taken at."""
        number = math.floor(step / self._steps + 1e-9)
        return number, math.ceil(number * self._steps - 1e-9)
