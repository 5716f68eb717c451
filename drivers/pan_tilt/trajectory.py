"""Jerk-limited motion of both axes, which arrive together; computed anew every cycle (ruckig)."""

from __future__ import annotations

from collections.abc import Sequence

from drivers.pan_tilt.trouble import Trouble
from zavis_bt.types import PanTiltSpec

_AXES = 2


class Trajectory:
    """Set-points in radians, one pair each period."""

    def __init__(self, spec: PanTiltSpec, max_jerk: float, period: float) -> None:
        """Stand at the origin.

        Args:
            spec: Greatest rate and acceleration, of each axis.
            max_jerk: Of each axis [rad/s³].
            period: Time between two set-points [s].
        """
        from ruckig import InputParameter, OutputParameter, Ruckig

        self._generator = Ruckig(_AXES, period)
        self._input, self._output = InputParameter(_AXES), OutputParameter(_AXES)
        self._input.max_velocity = [spec.max_rate] * _AXES
        self._input.max_acceleration = [spec.max_acceleration] * _AXES
        self._input.max_jerk = [max_jerk] * _AXES
        self.done = True
        """Whether the set-points have come to rest."""

    @property
    def position(self) -> tuple[float, float]:
        """The latest set-point [rad]."""
        pan, tilt = self._input.current_position
        return pan, tilt

    def hold(self, angles: Sequence[float]) -> None:
        """Stand at these angles from now on [rad]."""
        from ruckig import ControlInterface

        self._input.control_interface = ControlInterface.Position
        self._input.current_position = self._input.target_position = list(angles)
        self._input.current_velocity = self._input.current_acceleration = [0.0] * _AXES
        self._generator.reset()
        self.done = True

    def go_to(self, angles: Sequence[float]) -> None:
        """Head for these angles [rad] from wherever and however it moves now."""
        from ruckig import ControlInterface

        self._input.control_interface = ControlInterface.Position
        self._input.target_position = list(angles)
        self._input.target_velocity = [0.0] * _AXES
        self.done = False

    def halt(self) -> None:
        """Come to rest as fast as acceleration and jerk allow, wherever that is."""
        from ruckig import ControlInterface

        if self.done:
            return
        self._input.control_interface = ControlInterface.Velocity
        self._input.target_velocity = self._input.target_acceleration = [0.0] * _AXES

    def step(self) -> tuple[float, float]:
        """Advance by a period; return the set-point [rad].

        Raises:
            Trouble: There is no such trajectory.
        """
        if not self.done:
            result = self._generator.update(self._input, self._output)
            if result.value < 0:
                raise Trouble(f"no trajectory to {self._input.target_position} ({result.name})")
            self._output.pass_to_input(self._input)
            self.done = result.name == "Finished"
        return self.position
