"""The simulated pan-tilt unit."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

from sim.physics import Physics
from sim.trapezoid import Trapezoid, fastest
from zavis_bt.types import PanTiltSpec, PanTiltState


class _Move(NamedTuple):
    begun: float
    """[s]"""
    pan: Trapezoid
    tilt: Trapezoid


class SimPanTilt:
    """Two axes that move to their targets in trapezoidal profiles; at first both look straight ahead."""

    def __init__(self, physics: Physics, spec: PanTiltSpec, *, memory: float) -> None:
        """Mount a unit; ``memory`` is how long ago `angles_at` must still know [s]."""
        self._physics, self._spec, self._memory = physics, spec, memory
        pan, tilt = self._clipped(0.0, 0.0)
        self._moves = deque([_Move(0.0, self._axis(pan, 0.0, pan), self._axis(tilt, 0.0, tilt))])

    def state(self) -> PanTiltState:
        """Return the angles as they are now."""
        now, move = self._physics.now, self._moves[-1]
        elapsed = now - move.begun
        settled = elapsed >= max(move.pan.duration, move.tilt.duration)
        return PanTiltState(move.pan.at(elapsed)[0], move.tilt.at(elapsed)[0], settled, now)

    def move_to(self, pan: float, tilt: float) -> None:
        """Start a move to these angles [rad], clipped to the limits.

        Raises:
            ValueError: An angle is not a number.
        """
        if math.isnan(pan) or math.isnan(tilt):
            raise ValueError(f"pan {pan}, tilt {tilt}: not an angle")
        pan, tilt = self._clipped(pan, tilt)
        move = self._moves[-1]
        if (pan, tilt) != (move.pan.target, move.tilt.target):
            self._begin(pan, tilt)

    def stop(self) -> None:
        """Come to rest as fast as the acceleration allows."""
        move, elapsed = self._moves[-1], self._physics.now - self._moves[-1].begun
        pan, tilt = (self._rest(*axis.at(elapsed)) for axis in (move.pan, move.tilt))
        self._begin(pan, tilt)

    def angles_at(self, stamp: float) -> tuple[float, float]:
        """Return pan and tilt [rad] at a time within the memory [s]."""
        move = next(move for move in reversed(self._moves) if move.begun <= stamp or move is self._moves[0])
        return move.pan.at(stamp - move.begun)[0], move.tilt.at(stamp - move.begun)[0]

    def _begin(self, pan: float, tilt: float) -> None:
        now, move = self._physics.now, self._moves[-1]
        elapsed = now - move.begun
        (pan_now, pan_rate), (tilt_now, tilt_rate) = move.pan.at(elapsed), move.tilt.at(elapsed)
        self._moves.append(_Move(now, self._axis(pan_now, pan_rate, pan), self._axis(tilt_now, tilt_rate, tilt)))
        while self._moves[1].begun < now - self._memory:
            self._moves.popleft()

    def _axis(self, start: float, speed: float, target: float) -> Trapezoid:
        return fastest(start, speed, target, self._spec.max_rate, self._spec.max_acceleration)

    def _rest(self, position: float, speed: float) -> float:
        return position + speed * abs(speed) / (2 * self._spec.max_acceleration)

    def _clipped(self, pan: float, tilt: float) -> tuple[float, float]:
        spec = self._spec
        return min(max(pan, spec.pan_min), spec.pan_max), min(max(tilt, spec.tilt_min), spec.tilt_max)
