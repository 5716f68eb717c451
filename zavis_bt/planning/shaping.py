"""Velocity commands of the base made smooth: limited acceleration and jerk (ruckig)."""

from __future__ import annotations

from zavis_bt.types import BaseLimits, Twist2D

_PARTS = 2  # linear, angular
_NOTHING = 1e-12


class TwistShaper:
    """Follows commanded twists as fast as limits of velocity, acceleration and jerk allow, without overshoot.

    Linear and angular part are shaped each by itself. For what must stop at once, command the base without it and
    `reset` it afterwards.
    """

    def __init__(self, limits: BaseLimits, jerk_ratio: float = 10.0) -> None:
        """Begin at rest.

        Args:
            limits: Of the base.
            jerk_ratio: Greatest jerk as a multiple of the greatest acceleration [1/s]; its inverse is the time in
                which the greatest acceleration is reached.
        """
        from ruckig import ControlInterface, InputParameter, OutputParameter, Ruckig, Synchronization

        accelerations = [limits.linear_acceleration, limits.angular_acceleration]
        self._limits = limits
        self._generator = Ruckig(_PARTS, 0.1)
        self._input, self._output = InputParameter(_PARTS), OutputParameter(_PARTS)
        self._input.control_interface = ControlInterface.Velocity
        self._input.synchronization = Synchronization.No
        self._input.max_acceleration = accelerations
        self._input.max_jerk = [jerk_ratio * acceleration for acceleration in accelerations]

    def shape(self, twist: Twist2D, dt: float) -> Twist2D:
        """Return the velocity to drive with now.

        Args:
            twist: Commanded velocity, clipped to the limits.
            dt: Time since the last call [s].

        Raises:
            ArithmeticError: The command is no number.
        """
        target = self._clipped(twist.linear, twist.angular)
        if dt > 0:
            self._generator.delta_time = dt
            self._input.target_velocity = list(target)
            result = self._generator.update(self._input, self._output)
            if result.value < 0:
                raise ArithmeticError(f"no trajectory to {twist} ({result.name})")
            self._output.pass_to_input(self._input)
            self._arrive(target)
        return Twist2D(*self._clipped(*self._input.current_velocity))

    def reset(self, twist: Twist2D | None = None) -> None:
        """Begin anew at a velocity, without acceleration; at rest if not given."""
        start = twist or Twist2D()
        self._input.current_velocity = list(self._clipped(start.linear, start.angular))
        self._input.current_acceleration = [0.0] * _PARTS
        self._generator.reset()

    def _arrive(self, target: tuple[float, float]) -> None:
        """Take off the rounding errors of what has arrived, so that rest is exactly rest."""
        reached = zip(self._input.current_velocity, self._input.current_acceleration, target, strict=True)
        parts = [(goal, 0.0) if abs(v - goal) + abs(a) < _NOTHING else (v, a) for v, a, goal in reached]
        self._input.current_velocity = [velocity for velocity, _ in parts]
        self._input.current_acceleration = [acceleration for _, acceleration in parts]

    def _clipped(self, linear: float, angular: float) -> tuple[float, float]:
        limits = self._limits
        return (
            min(max(linear, -limits.max_reverse), limits.max_linear),
            min(max(angular, -limits.max_angular), limits.max_angular),
        )
