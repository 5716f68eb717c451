"""Rigid transforms and the pinhole camera.

Transforms are (4, 4) float64 arrays named ``transform_<from>_to_<to>``: they take points given in <from> to <to>.
"""

from __future__ import annotations

import math

import numpy as np

from zavis_bt.types import CameraIntrinsics, CameraSpec, FloatArray, Pose2D

_OPTICAL_TO_BODY = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def transform_camera_to_map(base: Pose2D, pan: float, tilt: float, camera: CameraSpec) -> FloatArray:
    """Return the pose of the optical camera frame in the map.

    Args:
        base: The base in the map.
        pan: Counter-clockwise from the base's heading [rad].
        tilt: Up from the horizon [rad].
        camera: Mount of the camera.

    Returns:
        (4, 4) transform of optical points (x right, y down, z forward) to the map.
    """
    heading = base.yaw + pan
    cos_h, sin_h, cos_t, sin_t = math.cos(heading), math.sin(heading), math.cos(tilt), math.sin(tilt)
    yaw = np.array([[cos_h, -sin_h, 0.0], [sin_h, cos_h, 0.0], [0.0, 0.0, 1.0]])
    pitch = np.array([[cos_t, 0.0, -sin_t], [0.0, 1.0, 0.0], [sin_t, 0.0, cos_t]])
    axis = base @ Pose2D(camera.x, 0.0)
    transform = np.eye(4)
    transform[:3, :3] = yaw @ pitch @ _OPTICAL_TO_BODY
    transform[:3, 3] = axis.x, axis.y, camera.height
    return transform


def project(points: FloatArray, transform_camera_to_map: FloatArray, intrinsics: CameraIntrinsics) -> FloatArray:
    """Project map points into the image.

    Args:
        points: (n, 3) in the map [m].
        transform_camera_to_map: (4, 4) camera pose.
        intrinsics: Camera model.

    Returns:
        (n, 3) rows of u, v [px] and depth along the optical axis [m]; u and v are NaN where depth ≤ 0.
    """
    rotation, position = transform_camera_to_map[:3, :3], transform_camera_to_map[:3, 3]
    x, y, z = ((np.asarray(points, dtype=np.float64) - position) @ rotation).T
    depth = np.where(z > 0, z, np.nan)
    return np.column_stack((intrinsics.fx * x / depth + intrinsics.cx, intrinsics.fy * y / depth + intrinsics.cy, z))


def back_project(pixels: FloatArray, depth: FloatArray, intrinsics: CameraIntrinsics) -> FloatArray:
    """Return the optical-frame points (n, 3) [m] of (n, 2) pixel positions (u, v) at (n,) depths [m]."""
    u, v = np.asarray(pixels, dtype=np.float64).T
    z = np.asarray(depth, dtype=np.float64)
    return np.column_stack(((u - intrinsics.cx) / intrinsics.fx * z, (v - intrinsics.cy) / intrinsics.fy * z, z))


def transform_points(transform: FloatArray, points: FloatArray) -> FloatArray:
    """Apply a (4, 4) rigid transform to (n, 3) points."""
    return np.asarray(points, dtype=np.float64) @ transform[:3, :3].T + transform[:3, 3]


def aim(base: Pose2D, camera: CameraSpec, point: tuple[float, float, float]) -> tuple[float, float]:
    """Return the pan and tilt [rad] that put a map point on the optical axis, limits not considered."""
    axis = base @ Pose2D(camera.x, 0.0)
    distance = math.hypot(point[0] - axis.x, point[1] - axis.y)
    return Pose2D(axis.x, axis.y, base.yaw).bearing(point[0], point[1]), math.atan2(point[2] - camera.height, distance)
