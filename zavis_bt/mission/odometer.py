"""How far and along which way a robot has driven."""

from __future__ import annotations

import math

import numpy as np

from zavis_bt.types import FloatArray, Pose2D

_STEP = 0.02  # distance between points of the trajectory [m]


class Odometer:
    """Sums up the poses of a base."""

    def __init__(self) -> None:
        self.driven = 0.0
        """Length of the way [m]."""
        self._last: Pose2D | None = None
        self._points: list[tuple[float, float]] = []

    def note(self, pose: Pose2D) -> None:
        """Note where the base is now."""
        if self._last is not None:
            self.driven += pose.distance(self._last)
        self._last = pose
        here = (pose.x, pose.y)
        if not self._points or math.dist(here, self._points[-1]) >= _STEP:
            self._points.append(here)

    @property
    def trajectory(self) -> FloatArray:
        """(n, 2) positions [m]."""
        return np.array(self._points, dtype=np.float64).reshape(-1, 2)
