"""Where to stand to look at a landmark."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.planning.costmap import Costmap
from zavis_bt.planning.geodesic import GeodesicField
from zavis_bt.types import OCCUPIED, FloatArray, Landmark, Pose2D, Viewpoint

_RADIAL_STEP = 0.1  # between stands on a bearing [m]
_FAN = math.radians(12)  # stands a little aside of the bearing are tried too [rad]
_OWN_MARGIN = 0.15  # obstacles this near to the landmark's extent are its own [m]


def generate_viewpoints(
    landmark: Landmark,
    costmap: Costmap,
    field: GeodesicField,
    *,
    bearings: int = 8,
    min_distance: float = 0.5,
    max_distance: float = 1.6,
) -> list[Viewpoint]:
    """Find places around a landmark to look at it from (section Waypoint Generator).

    On each bearing the best stand is taken that fits the robot's outline, can be reached and has a clear line of sight
    to the landmark. Best is: room to turn, then comfortable clearance, then the middle of the allowed distances, which
    are measured from the landmark's surface: its outermost obstacle cell on the bearing. Obstacle cells within the
    landmark's radius of its position, and a margin, are its own and hide nothing. Deterministic.

    Args:
        landmark: What to look at.
        costmap: Where the robot fits.
        field: Path lengths from the robot.
        bearings: Number of directions around the landmark.
        min_distance: Nearest stand, from the landmark's surface [m].
        max_distance: Farthest stand, from the landmark's surface [m].

    Returns:
        At most one viewpoint for each bearing, in the order of the bearings from the x axis counter-clockwise.
    """
    x, y, _ = landmark.position
    distances = np.arange(min_distance, max_distance + 1e-9, _RADIAL_STEP)
    angles = np.arange(bearings) * (math.tau / bearings)
    aside = np.array([0.0, _FAN, -_FAN])
    angle, off, reach = (grid.ravel() for grid in np.meshgrid(angles, aside, distances, indexing="ij"))
    toward = np.column_stack((np.cos(angle + off), np.sin(angle + off)))
    points = toward * (_surface(landmark, costmap, toward) + reach)[:, None] + (x, y)
    merit = _merit(costmap, points, reach, off, (min_distance + max_distance) / 2)
    merit[~_usable(landmark, costmap, field, points)] = -math.inf
    found = []
    for stands in np.split(np.arange(len(points)), bearings):
        best = stands[int(merit[stands].argmax())]
        if merit[best] > -math.inf:
            found.append(_viewpoint(landmark, points[best]))
    return found


def _usable(landmark: Landmark, costmap: Costmap, field: GeodesicField, points: FloatArray) -> NDArray[np.bool_]:
    """Where the robot fits, gets to and sees the landmark from."""
    usable = costmap.fits(points)
    usable[usable] &= _sees(landmark, costmap, points[usable])
    usable[usable] &= field.reaches(points[usable])
    if not costmap.footprint.disc:
        usable[usable] &= np.array(
            [costmap.pose_fits(_facing(landmark, point)) for point in points[usable]], dtype=bool
        )
    return usable


def _merit(costmap: Costmap, points: FloatArray, reach: FloatArray, off: FloatArray, middle: float) -> FloatArray:
    """How good a stand is, if it is usable: [m] of distance from the best one, roughly."""
    spare = costmap.clearance(points) - costmap.turning_radius
    return 2.0 * np.clip(spare, -0.2, 0.0) + np.clip(spare, 0.0, 0.2) - np.abs(reach - middle) - 0.2 * np.abs(off)


def _surface(landmark: Landmark, costmap: Costmap, toward: FloatArray) -> FloatArray:
    """Return the (n,) distances from the landmark's position to its surface in (n, 2) directions [m].

    The position may be the middle of a front face, so the distance differs from bearing to bearing.
    """
    x, y, _ = landmark.position
    ((u, v),) = costmap.to_uv(np.array([[x, y]]))
    resolution = costmap.grid.resolution
    surface: FloatArray = _outermost(costmap.grid.states, u, v, toward, (landmark.radius + _OWN_MARGIN) / resolution)
    return np.minimum(surface * resolution, landmark.radius)


def _sees(landmark: Landmark, costmap: Costmap, points: FloatArray) -> NDArray[np.bool_]:
    x, y, _ = landmark.position
    ((u, v),) = costmap.to_uv(np.array([[x, y]]))
    own = (landmark.radius + _OWN_MARGIN) / costmap.grid.resolution
    seen: NDArray[np.bool_] = _in_sight(costmap.grid.states, costmap.to_uv(points), u, v, own)
    return seen


def _facing(landmark: Landmark, point: FloatArray) -> Pose2D:
    x, y, _ = landmark.position
    return Pose2D(float(point[0]), float(point[1]), math.atan2(y - point[1], x - point[0]))


def _viewpoint(landmark: Landmark, point: FloatArray) -> Viewpoint:
    return Viewpoint(_facing(landmark, point), landmark.position, landmark.radius, landmark.id, landmark.label)


@njit(cache=True, nogil=True)
def _outermost(states: NDArray[np.int8], u: float, v: float, toward: FloatArray, reach: float) -> FloatArray:
    """Return the (n,) distances to the outermost occupied cell within reach, 0 if there is none."""
    rows, cols = states.shape
    found = np.zeros(len(toward))
    for i in range(len(toward)):
        for k in range(math.floor(2 * reach) + 1):
            row, col = round(v + 0.5 * k * toward[i, 1]), round(u + 0.5 * k * toward[i, 0])
            if 0 <= row < rows and 0 <= col < cols and states[row, col] == OCCUPIED:
                found[i] = 0.5 * k
    return found


@njit(cache=True, nogil=True)
def _in_sight(states: NDArray[np.int8], points: FloatArray, u1: float, v1: float, own: float) -> NDArray[np.bool_]:
    """Return (n,) whether no occupied cell farther than ``own`` from the target lies on the line to it."""
    rows, cols = states.shape
    seen = np.ones(len(points), dtype=np.bool_)
    for i in range(len(points)):
        du, dv = u1 - points[i, 0], v1 - points[i, 1]
        length = math.hypot(du, dv)
        count = math.ceil(4 * max(length - own, 0.0))  # up to the landmark, four samples a cell
        for k in range(count):
            share = k / (4 * length)
            row, col = round(points[i, 1] + share * dv), round(points[i, 0] + share * du)
            if 0 <= row < rows and 0 <= col < cols and states[row, col] == OCCUPIED:
                seen[i] = False
                break
    return seen
