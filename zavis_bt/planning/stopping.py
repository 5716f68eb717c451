"""Whether an outline that drives on for a moment and then brakes stays clear of points. Lengths in metres."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from zavis_bt.types import FloatArray, Footprint

STEP = 0.02
"""Time between the poses that are checked [s]."""
_STRIDE = 0.01  # distance between the poses that are checked beyond the halt [m]
_LONGEST = 1000  # steps after which a base that does not come to rest counts as one that hits
_OWN = 0.4  # points deeper inside than this share of the inscribed radius are the robot's own parts
_NUMERIC = 1e-6  # [m]


class Outline(NamedTuple):
    """A robot's outline about the base's origin [m]."""

    disc: bool
    front: float
    """Also a disc's radius."""
    back: float
    half_width: float

    @classmethod
    def of(cls, footprint: Footprint, tolerance: float = 0.0) -> Outline:
        """Return a footprint's outline, smaller by the tolerance [m] on all sides."""
        half = footprint.length / 2 - tolerance
        centre = footprint.centre_x
        return cls(footprint.disc, half + centre, half - centre, footprint.width / 2 - tolerance)

    @property
    def reach(self) -> float:
        """Distance of its farthest point from the origin [m]."""
        return self.front if self.disc else math.hypot(max(self.front, self.back), self.half_width)


class Velocity(NamedTuple):
    """Forward [m/s] and counter-clockwise [rad/s]; also accelerations in these units a second."""

    linear: float
    angular: float


class Course(NamedTuple):
    """What the base does until it rests: goes on as before, then as asked, then slows down to rest."""

    now: Velocity
    """Measured."""
    before: Velocity
    """Asked for earlier, followed for ``delay``."""
    delay: float
    """How old ``now`` is [s]."""
    asked: Velocity
    """Followed for ``reaction``."""
    reaction: float
    """Time until the base is told otherwise [s]."""
    speeding: Velocity
    """Accelerations."""
    slowing: Velocity
    """Decelerations."""
    extra: float
    """Distance to stay free beyond the halt, straight on [m]."""

    @property
    def length(self) -> float:
        """Upper bound of the way until the end [m]."""
        linear = max(abs(self.now.linear), abs(self.before.linear), abs(self.asked.linear))
        return linear * (self.delay + self.reaction + 2 * STEP) + linear**2 / (2 * self.slowing.linear) + self.extra


@njit(cache=True, nogil=True)
def points_near(
    ranges: FloatArray,
    angle_min: float,
    angle_increment: float,
    range_min: float,
    sensor: tuple[float, float, float],
    reach: float,
) -> FloatArray:
    """Return the (n, 2) end points of beams within reach of the base, in the base frame [m].

    Args:
        ranges: (m,) [m]; beams without return (inf, NaN) are left out.
        angle_min: Direction of the first beam in the sensor's frame [rad].
        angle_increment: [rad]
        range_min: Nearer returns are broken [m].
        sensor: x, y [m] and yaw [rad] of the sensor in the base frame.
        reach: [m]
    """
    x0, y0, yaw = sensor
    farthest = reach + math.hypot(x0, y0)
    points, count = np.empty((len(ranges), 2)), 0
    for i in range(len(ranges)):
        if not range_min <= ranges[i] <= farthest:
            continue
        angle = yaw + angle_min + i * angle_increment
        x, y = x0 + ranges[i] * math.cos(angle), y0 + ranges[i] * math.sin(angle)
        if x * x + y * y <= reach * reach:
            points[count, 0], points[count, 1] = x, y
            count += 1
    return points[:count].copy()


@njit(cache=True, nogil=True)
def depths(points: FloatArray, outline: Outline, x: float, y: float, yaw: float) -> FloatArray:
    """Return how deep each of (n, 2) points lies inside an outline at a pose [m]; negative outside."""
    found = np.empty(len(points))
    cos, sin = math.cos(yaw), math.sin(yaw)
    for i in range(len(points)):
        found[i] = _depth(outline, cos, sin, points[i, 0] - x, points[i, 1] - y)
    return found


@njit(cache=True, nogil=True)
def without_own_parts(points: FloatArray, outline: Outline) -> FloatArray:
    """Return those of (n, 2) points that are not so deep inside the outline that they must be the robot's own."""
    inner = outline.front if outline.disc else min(outline.front, outline.back, outline.half_width)
    return points[depths(points, outline, 0.0, 0.0, 0.0) < _OWN * inner]


@njit(cache=True, nogil=True)
def stays_free(points: FloatArray, outline: Outline, course: Course, give: float) -> bool:
    """Return whether no point gets into the outline on a course, or deeper into it than it is.

    The velocity follows its target within the accelerations; the poses follow arcs of constant twist.

    Args:
        points: (n, 2) obstacles in the base frame [m].
        outline: The robot.
        course: What it does.
        give: Points may get as deep as the deepest one is, but no deeper than this [m].
    """
    if len(points) == 0:
        return True
    allowed = depths(points, outline, 0.0, 0.0, 0.0)
    least = min(max(allowed.max(), 0.0), give)
    allowed = np.maximum(allowed, least) + _NUMERIC
    x, y, yaw = 0.0, 0.0, 0.0
    v, w = course.now
    handover, end = course.delay, course.delay + course.reaction
    heading = 0.0
    for step in range(_LONGEST):
        time = step * STEP + 1e-9
        braking = time >= end
        target = Velocity(0.0, 0.0) if braking else (course.asked if time >= handover else course.before)
        if braking and heading == 0.0:
            heading = 1.0 if v > 0.0 else (-1.0 if v < 0.0 else 2.0)
        if braking and v == 0.0 and w == 0.0:
            return heading == 2.0 or _way_on_is_free(points, outline, allowed, x, y, yaw, heading, course.extra)
        next_v = _follow(v, target.linear, course.speeding.linear * STEP, course.slowing.linear * STEP)
        next_w = _follow(w, target.angular, course.speeding.angular * STEP, course.slowing.angular * STEP)
        driven, turned = (v + next_v) / 2 * STEP, (w + next_w) / 2 * STEP
        x, y = x + driven * math.cos(yaw + turned / 2), y + driven * math.sin(yaw + turned / 2)
        yaw, v, w = yaw + turned, next_v, next_w
        if _deeper(points, outline, allowed, x, y, yaw):
            return False
    return False


@njit(cache=True, nogil=True)
def _way_on_is_free(
    points: FloatArray,
    outline: Outline,
    allowed: FloatArray,
    x: float,
    y: float,
    yaw: float,
    heading: float,
    extra: float,
) -> bool:
    strides = math.ceil(extra / _STRIDE - 1e-9)
    for i in range(strides):
        way = heading * extra * (i + 1) / strides
        if _deeper(points, outline, allowed, x + way * math.cos(yaw), y + way * math.sin(yaw), yaw):
            return False
    return True


@njit(cache=True, nogil=True)
def _deeper(points: FloatArray, outline: Outline, allowed: FloatArray, x: float, y: float, yaw: float) -> bool:
    cos, sin = math.cos(yaw), math.sin(yaw)
    worst = 0.0
    for i in range(len(points)):
        worst = max(worst, _depth(outline, cos, sin, points[i, 0] - x, points[i, 1] - y) - allowed[i])
    return worst > 0.0


@njit(cache=True, nogil=True)
def _depth(outline: Outline, cos: float, sin: float, dx: float, dy: float) -> float:
    if outline.disc:
        return outline.front - math.hypot(dx, dy)
    ahead, aside = cos * dx + sin * dy, cos * dy - sin * dx
    return min(outline.front - ahead, outline.back + ahead, outline.half_width - abs(aside))


@njit(cache=True, nogil=True)
def _follow(value: float, target: float, faster: float, slower: float) -> float:
    """Return the next value on the way to a target: towards zero by ``slower``, away from it by ``faster``."""
    change = slower if value * (target - value) < 0.0 else faster
    return value + min(max(target - value, -change), change)
