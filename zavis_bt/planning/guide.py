"""What to aim at on a path, how fast, and how exactly."""

from __future__ import annotations

import math
from typing import NamedTuple, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.planning.costmap import Costmap
from zavis_bt.planning.distance_field import DistanceField
from zavis_bt.planning.grid_kernels import clearance, line_fits
from zavis_bt.planning.track import Track, point_at
from zavis_bt.types import FloatArray, Pose2D, RobotSpec

_LOOK_AHEAD = 0.9  # farthest target [m]
_NEAR = 0.15  # target where the robot can go straight to none [m]
_TOO_NEAR = 0.5  # a target nearer than this gives no direction [cells]
_KEEP_OFF, _CUT = (
    0.05,
    0.005,
)  # lines to targets are as clear as the path but for so much, or so much beyond the radius [m]
_STEP = 0.05  # between the points of the path that are tried and measured [m]
_SLOWEST = 0.1  # [m/s]
_SPEED_PER_CLEARANCE = 2.2  # [1/s]
_SLOW_AHEAD = 0.45  # obstacles beside this much of the path ahead matter for the speed [m]
_NARROW = 0.02  # spare clearance below which a passage is narrow [m]
_NARROW_UNTURNABLE = 0.1  # the same for an outline that cannot turn there [m]
_TOUCHING = 0.008  # spare clearance below which the outline all but touches [m]
_AT_ENTRY = 0.05  # at the mouth of a narrow passage from here on [m]
_BRAKING = 0.7  # share of the base's deceleration that is planned with

_T = TypeVar("_T", bound=np.generic)


class Aim(NamedTuple):
    """What to do next."""

    target: tuple[float, float]
    """Where to go in a straight line [m]."""
    speed_limit: float
    """[m/s]"""
    exact: bool
    """Whether the passage is so narrow that the heading must be right before driving on."""
    in_sight: bool
    """Whether the straight line to the target is free."""


class Guide:
    """Chooses targets on a path.

    In the open the target is the farthest point ahead to which the robot can go straight. Narrow is where a disc only
    just fits, and where a rectangle cannot turn: there the robot goes first to the mouth, then along the path's line.
    """

    def __init__(self, spec: RobotSpec, track: Track) -> None:
        """Take the path.

        Args:
            spec: Robot that drives.
            track: The path, and how far the robot is.
        """
        self._spec, self._track = spec, track
        self._samples = np.arange(0.0, track.length + _STEP, _STEP)
        self._points = np.array([track.at(arc) for arc in self._samples])

    def use(self, costmap: Costmap) -> None:
        """Measure the path on a new map."""
        self._costmap = costmap
        self._uv = costmap.to_uv(self._track.points)
        self._clearance = costmap.clearance(self._points)
        self._narrow = self._narrow_stretches(costmap)

    def aim(self, pose: Pose2D) -> Aim:
        """Return what to do next."""
        costmap, position = self._costmap, self._track.position
        (x0, y0), resolution = costmap.grid.origin, costmap.grid.resolution
        reach = min(_LOOK_AHEAD, self._until_narrow(position), self._until_bend(position))
        wanted = min(float(self._ahead(position, reach).min()) - _CUT, costmap.radius + _KEEP_OFF)
        arc, here = _farthest_in_sight(
            costmap.field,
            costmap.barred,
            costmap.radius / resolution,
            wanted / resolution,
            self._uv,
            self._track.arc,
            position,
            reach,
            (pose.x - x0) / resolution - 0.5,
            (pose.y - y0) / resolution - 0.5,
        )
        near = min(float(self._ahead(position, _SLOW_AHEAD).min()), here * resolution)
        spare = near - self._spec.footprint.inscribed_radius
        exact = bool(self._stretch(self._narrow, position, 0.2).any()) or spare < _TOUCHING
        target = self._track.at(arc if arc >= 0.0 else position + _NEAR)
        return Aim(target, self._speed_limit(position, spare), exact, arc >= 0.0)

    def _narrow_stretches(self, costmap: Costmap) -> NDArray[np.bool_]:
        """Which points of the path are in a narrow passage, with its mouth up to where a rectangle can turn."""
        spare = _NARROW if costmap.footprint.disc else _NARROW_UNTURNABLE
        hard = self._clearance < costmap.radius + spare
        tight = self._clearance < costmap.turning_radius + _NARROW
        stretch = np.cumsum(
            np.diff(tight, prepend=False)
        )  # numbers the stretches that are tight and those that are not
        return tight & np.isin(stretch, stretch[hard])

    def _ahead(self, position: float, length: float) -> FloatArray:
        """Clearances of the path from a position on."""
        return self._stretch(self._clearance, position, length)

    def _stretch(self, samples: NDArray[_T], position: float, length: float) -> NDArray[_T]:
        first = min(int(position / _STEP), len(self._samples) - 1)
        return samples[first : first + int(length / _STEP) + 1]

    def _until_narrow(self, position: float) -> float:
        """How far ahead a narrow passage begins [m]; inf if none does soon, or the robot is at or in it."""
        ahead = self._stretch(self._narrow, position, _LOOK_AHEAD)
        distance = float(ahead.argmax()) * _STEP
        return distance if ahead.any() and distance > _AT_ENTRY else math.inf

    def _until_bend(self, position: float) -> float:
        """How far ahead the path bends or the passage widens, if the outline cannot turn here [m]; inf elsewhere."""
        if self._costmap.footprint.disc:
            return math.inf
        ahead = self._stretch(self._narrow, position, _LOOK_AHEAD)
        if not ahead[0]:
            return math.inf
        corners = self._track.arc[self._track.arc > position + _AT_ENTRY]
        widens = float(ahead.argmin()) * _STEP if not ahead.all() else math.inf
        return min(float(corners[0]) - position if len(corners) else math.inf, widens + _AT_ENTRY)

    def _speed_limit(self, position: float, spare: float) -> float:
        """Slow near obstacles, before narrow passages and before the end [m/s]."""
        deceleration = _BRAKING * self._spec.limits.linear_acceleration
        left = min(self._track.remaining, self._until_narrow(position))
        return max(min(_SLOWEST + _SPEED_PER_CLEARANCE * spare, math.sqrt(2 * deceleration * left)), _SLOWEST)


@njit(cache=True, nogil=True)
def _farthest_in_sight(
    field: DistanceField,
    barred: NDArray[np.bool_],
    least: float,
    radius: float,
    points: FloatArray,
    arc: FloatArray,
    position: float,
    ahead: float,
    u: float,
    v: float,
) -> tuple[float, float]:
    """Return the arc length of the farthest target [m], -1 if there is none, and the robot's own clearance [cells].

    The line to the target keeps the clearance ``radius``, or the robot's own where that is less, but never less than
    ``least``.
    """
    here = clearance(field, u, v)
    radius = max(min(radius, here - 1e-3), least)
    while ahead > 0.0:
        target_u, target_v = point_at(points, arc, position + ahead)
        far = math.hypot(target_u - u, target_v - v) > _TOO_NEAR
        if far and line_fits(field, barred, radius, u, v, target_u, target_v):
            return position + ahead, here
        ahead -= _STEP
    return -1.0, here
