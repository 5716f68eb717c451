"""What the camera has looked at: landmarks that were searched, and landmarks that should have been seen again."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from zavis_bt.mapping.line_of_sight import clear_line
from zavis_bt.types import OCCUPIED, CameraIntrinsics, FloatArray, GridMap, Landmark, RgbdFrame

_SPREAD = 0.7  # share of the radius at which a landmark's sides are sampled
_OWN_CELLS = 0.15  # beyond the radius, where occupied cells are the landmark's own [m]
_RECOGNISED = 1.0, 4.0  # distances from which furniture ought to be recognised [m]
_BORDER = 0.03  # share of the image at its edges where things are cut off


class Views:
    """Remembers from where the camera looked.

    A landmark counts as searched by what was in view, not by its identity: a table that is first recognised later, or
    gets another name, need not be visited again.
    """

    def __init__(self) -> None:
        self._transforms: list[FloatArray] = []
        self._cameras: list[CameraIntrinsics] = []
        self._searched_from = 0

    def add(self, frame: RgbdFrame) -> None:
        """Note that a frame was looked at; its pixels are not kept."""
        self._transforms.append(frame.transform_camera_to_map)
        self._cameras.append(frame.intrinsics)

    def forget_search(self) -> None:
        """Let nothing count as searched any more, as for another round or target."""
        self._searched_from = len(self._transforms)

    def chances(self, landmarks: Sequence[Landmark], grid: GridMap) -> NDArray[np.intp]:
        """Return in how many views each landmark ought to have been recognised, (n,).

        Those are the views with its middle in the image, between 1 m and 4 m away, with nothing on the map between.
        """
        if not self._transforms:
            return np.zeros(len(landmarks), dtype=np.intp)
        views = _Poses(np.stack(self._transforms), self._cameras)
        blocked = grid.states == OCCUPIED
        return np.array([_chances(each, views, grid, blocked) for each in landmarks], dtype=np.intp)

    def searched(self, landmarks: Sequence[Landmark], grid: GridMap, max_distance: float) -> frozenset[int]:
        """Return the ids of the landmarks that were in view from near enough to find what is on them.

        The middle and both sides must each have been in some view, with nothing on the map between.

        Args:
            landmarks: On the semantic map.
            grid: What can stand between.
            max_distance: From the camera, along the floor [m].
        """
        begin = self._searched_from
        if begin == len(self._transforms):
            return frozenset()
        views = _Poses(np.stack(self._transforms[begin:]), self._cameras[begin:])
        blocked = grid.states == OCCUPIED
        return frozenset(each.id for each in landmarks if _shown(each, views, grid, blocked, max_distance))


class _Poses:
    """Camera poses and models as arrays, a row a view."""

    def __init__(self, transforms: FloatArray, cameras: Sequence[CameraIntrinsics]) -> None:
        self.rotation, self.position = transforms[:, :3, :3], transforms[:, :3, 3]
        # How far a point may lie off the optical axis, per metre of depth, left/right and up/down.
        self.reach_x = np.array([(0.5 - _BORDER) * c.width / c.fx for c in cameras])
        self.reach_y = np.array([(0.5 - _BORDER) * c.height / c.fy for c in cameras])


def _shown(landmark: Landmark, views: _Poses, grid: GridMap, blocked: NDArray[np.bool_], max_distance: float) -> bool:
    x, y, z = landmark.position
    offset = np.array([x, y]) - views.position[:, :2]
    away = np.hypot(offset[:, 0], offset[:, 1])
    near = np.flatnonzero((away <= max_distance + landmark.radius) & (away > 1e-6))
    if not len(near):
        return False
    offset, away = offset[near], away[near]
    across = np.column_stack((-offset[:, 1], offset[:, 0])) / away[:, None] * landmark.radius * _SPREAD
    shown = True
    for side in (0.0, 1.0, -1.0):
        points = np.column_stack((np.array([x, y]) + side * across, np.full(len(near), z)))
        framed = near[_framed(points, views, near) & _within(points, views, near, max_distance)]
        chosen = points[np.isin(near, framed)]
        shown = shown and _any_in_sight(chosen[:, :2], views.position[framed, :2], landmark.radius, grid, blocked)
    return shown


def _chances(landmark: Landmark, views: _Poses, grid: GridMap, blocked: NDArray[np.bool_]) -> int:
    middle = np.array(landmark.position)
    offset = middle[:2] - views.position[:, :2]
    away = np.hypot(offset[:, 0], offset[:, 1])
    near = np.flatnonzero((away >= _RECOGNISED[0]) & (away <= _RECOGNISED[1]))
    near = near[_framed(np.broadcast_to(middle, (len(near), 3)), views, near)]
    return sum(_in_sight(middle[:2], views.position[i, :2], landmark.radius, grid, blocked) for i in near)


def _framed(points: FloatArray, views: _Poses, chosen: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Tell which points, one a view, lie inside the image of their view."""
    optical = np.einsum("nij,ni->nj", views.rotation[chosen], points - views.position[chosen])
    depth = optical[:, 2]
    inside_x = np.abs(optical[:, 0]) <= views.reach_x[chosen] * depth
    inside_y = np.abs(optical[:, 1]) <= views.reach_y[chosen] * depth
    return np.asarray((depth > 0) & inside_x & inside_y)


def _within(points: FloatArray, views: _Poses, chosen: NDArray[np.intp], distance: float) -> NDArray[np.bool_]:
    offset = points[:, :2] - views.position[chosen, :2]
    return np.asarray(np.hypot(offset[:, 0], offset[:, 1]) <= distance)


def _any_in_sight(
    points: FloatArray, cameras: FloatArray, radius: float, grid: GridMap, blocked: NDArray[np.bool_]
) -> bool:
    """Tell whether some camera sees its point."""
    return any(_in_sight(point, camera, radius, grid, blocked) for point, camera in zip(points, cameras, strict=True))


def _in_sight(point: FloatArray, camera: FloatArray, radius: float, grid: GridMap, blocked: NDArray[np.bool_]) -> bool:
    """Tell whether nothing on the map stands between, up to the landmark's own cells."""
    offset = point - camera
    share = max(1 - (radius + _OWN_CELLS) / max(float(np.hypot(*offset)), 1e-6), 0.0)
    origin, end = grid.to_cells(np.stack((camera, camera + offset * share)))
    return clear_line(blocked, (int(origin[0]), int(origin[1])), (int(end[0]), int(end[1])))
