"""Which landmarks a set of frames has searched."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from zavis_bt.geometry import project
from zavis_bt.mapping.line_of_sight import visible_from
from zavis_bt.types import OCCUPIED, FloatArray, GridMap, Landmark, RgbdFrame

_SPREAD = 0.7  # share of the radius at which a landmark's sides are sampled
_OWN_CELLS = 0.15  # beyond the radius, where occupied cells are the landmark's own [m]
_BORDER = 0.03  # share of the image at its edges where things are cut off


def searched_landmarks(
    landmarks: Sequence[Landmark], frames: Sequence[RgbdFrame], grid: GridMap, max_distance: float
) -> list[int]:
    """Return the landmarks that the frames show from near enough to find what is on them.

    A landmark counts as shown if its middle and both its sides are each in some frame, within the distance and with
    nothing on the map between.

    Args:
        landmarks: On the semantic map.
        frames: Taken from one place or several.
        grid: What can stand between.
        max_distance: From the camera to the landmark's surface, along the floor [m].

    Returns:
        Ids, in the order of the landmarks.
    """
    if not frames or not landmarks:
        return []
    blocked = grid.states == OCCUPIED
    seen = np.zeros((len(landmarks), 3), dtype=np.bool_)
    for frame in frames:
        for i, landmark in enumerate(landmarks):
            if not seen[i].all():
                seen[i] |= _seen_points(landmark, frame, grid, blocked, max_distance)
    return [landmark.id for landmark, points in zip(landmarks, seen, strict=True) if points.all()]


def _seen_points(
    landmark: Landmark, frame: RgbdFrame, grid: GridMap, blocked: NDArray[np.bool_], max_distance: float
) -> NDArray[np.bool_]:
    camera_x, camera_y = frame.transform_camera_to_map[:2, 3].tolist()
    x, y, z = landmark.position
    away = math.hypot(x - camera_x, y - camera_y)
    if not 1e-6 < away <= max_distance + landmark.radius:
        return np.zeros(3, dtype=np.bool_)
    across = np.array([-(y - camera_y), x - camera_x]) / away * landmark.radius * _SPREAD
    points = np.array([[x, y], [x + across[0], y + across[1]], [x - across[0], y - across[1]]])
    shown = _in_image(np.column_stack((points, np.full(3, z))), frame)
    near = np.hypot(points[:, 0] - camera_x, points[:, 1] - camera_y) <= max_distance
    return np.asarray(shown & near & _in_sight(points, (camera_x, camera_y), landmark.radius, grid, blocked))


def _in_image(points: FloatArray, frame: RgbdFrame) -> NDArray[np.bool_]:
    camera = frame.intrinsics
    u, v, depth = project(points, frame.transform_camera_to_map, camera).T
    with np.errstate(invalid="ignore"):
        return np.asarray(
            (depth > 0)
            & (np.abs(u / camera.width - 0.5) <= 0.5 - _BORDER)
            & (np.abs(v / camera.height - 0.5) <= 0.5 - _BORDER)
        )


def _in_sight(
    points: FloatArray, camera: tuple[float, float], radius: float, grid: GridMap, blocked: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Tell whether the way to each point is clear up to the landmark's own cells."""
    origin = np.array(camera)
    offsets = points - origin
    lengths = np.hypot(offsets[:, 0], offsets[:, 1])
    share = np.maximum(1 - (radius + _OWN_CELLS) / np.maximum(lengths, 1e-6), 0.0)
    ends = origin + offsets * share[:, None]
    row, col = grid.to_cells(origin[None])[0]
    return visible_from(blocked, (int(row), int(col)), grid.to_cells(ends))
