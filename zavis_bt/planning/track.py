"""Where on its path a robot is."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from zavis_bt.types import FloatArray, Path

_BACK, _AHEAD = 0.15, 0.8  # the position on the path is looked for this far around the last one [m]


class Track:
    """A path and how far along it the robot has come. Arc lengths in metres from the path's start."""

    def __init__(self, path: Path) -> None:
        """Begin at the start of the path.

        Args:
            path: At least two points; copied.
        """
        self.points = np.array(path.points, dtype=np.float64)
        steps = np.hypot(*np.diff(self.points, axis=0).T)
        self.arc = np.concatenate(([0.0], np.cumsum(steps)))
        self.position = 0.0
        """How far the robot has come [m]."""

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self.arc[-1])

    @property
    def remaining(self) -> float:
        """Length still to go [m]."""
        return self.length - self.position

    def advance(self, x: float, y: float) -> float:
        """Move on to the nearest point of the path around the last one; return the distance to it [m].

        Looking only there keeps a robot from jumping where the path passes itself.
        """
        self.position, off = _project(self.points, self.arc, self.position - _BACK, self.position + _AHEAD, x, y)
        return float(off)

    def at(self, arc: float) -> tuple[float, float]:
        """Return the point at an arc length [m]."""
        x, y = point_at(self.points, self.arc, arc)
        return float(x), float(y)

    def stretch(self, begin: float, end: float) -> FloatArray:
        """Return the (n, 2) points of the path between two arc lengths [m]."""
        inner = self.points[(self.arc > begin) & (self.arc < end)]
        return np.vstack((self.at(begin), inner, self.at(end)))


@njit(cache=True, nogil=True)
def _project(points: FloatArray, arc: FloatArray, begin: float, end: float, x: float, y: float) -> tuple[float, float]:
    best, found = math.inf, max(begin, 0.0)
    for i in range(len(points) - 1):
        length = arc[i + 1] - arc[i]
        if arc[i + 1] < begin or arc[i] > end or length <= 0.0:
            continue
        dx, dy = (points[i + 1, 0] - points[i, 0]) / length, (points[i + 1, 1] - points[i, 1]) / length
        along = (x - points[i, 0]) * dx + (y - points[i, 1]) * dy
        along = min(max(along, begin - arc[i], 0.0), end - arc[i], length)
        squared = (points[i, 0] + along * dx - x) ** 2 + (points[i, 1] + along * dy - y) ** 2
        if squared < best:
            best, found = squared, arc[i] + along
    return found, math.sqrt(best) if best < math.inf else 0.0


@njit(cache=True, nogil=True)
def point_at(points: FloatArray, arc: FloatArray, position: float) -> tuple[float, float]:
    """Return the point of a polyline at an arc length; ``arc`` (n,) are those of its (n, 2) points."""
    i = 0
    while i < len(points) - 2 and arc[i + 1] <= position:
        i += 1
    length = arc[i + 1] - arc[i]
    share = min(max((position - arc[i]) / length, 0.0), 1.0) if length > 0.0 else 0.0
    return (
        points[i, 0] + share * (points[i + 1, 0] - points[i, 0]),
        points[i, 1] + share * (points[i + 1, 1] - points[i, 1]),
    )
