"""The robot in the scene."""

from __future__ import annotations

import numpy as np

from zavis_bt.types import CameraSpec, FloatArray, Pose2D, RobotSpec
from zavis_bt.viz.solids import Colour, Solid, box, cylinder, flat, merged

_BODY: Colour = (38, 98, 217)
_DARK: Colour = (40, 46, 60)
_NOSE: Colour = (255, 214, 64)
_SIGHT = 1.4  # how far the drawn camera frustum reaches at most [m]
_BODY_HEIGHT = 0.22  # [m]


def body(spec: RobotSpec) -> Solid:
    """Return the footprint as a block, with its heading, the LiDAR and the mast, in the base frame."""
    outline = spec.footprint
    front, side = outline.centre_x + outline.length / 2, outline.width / 2
    if outline.disc:
        parts = [cylinder((0, 0, 0.03), outline.length / 2, _BODY_HEIGHT, _BODY)]
    else:
        parts = [box((front - outline.length, -side, 0.03), (front, side, 0.03 + _BODY_HEIGHT), _BODY)]
    top = 0.03 + _BODY_HEIGHT + 0.004
    nose = np.array([[front * 0.92, 0.0], [front * 0.35, side * 0.6], [front * 0.35, -side * 0.6]])
    parts.append(flat(nose, top, _NOSE))
    lidar = spec.lidar
    parts.append(cylinder((lidar.mount.x, lidar.mount.y, max(top, lidar.height - 0.05)), 0.05, 0.08, _DARK))
    if spec.camera.height > top:
        parts.append(cylinder((spec.camera.x, 0, top), 0.018, spec.camera.height - top, _DARK, sides=10))
    return merged(parts)


def camera(spec: CameraSpec) -> Solid:
    """Return the camera's housing in its own frame: x along the optical axis, z up."""
    return box((-0.03, -0.06, -0.03), (0.05, 0.06, 0.035), _DARK)


def frustum(spec: CameraSpec) -> tuple[FloatArray, Solid]:
    """Return what the camera sees, in the frame of `camera`: (2n, 3) end points of its edges, and its sides."""
    reach = min(spec.depth_max, _SIGHT)
    half_width = reach * spec.intrinsics.width / 2 / spec.intrinsics.fx
    half_height = reach * spec.intrinsics.height / 2 / spec.intrinsics.fy
    corners = np.array([[reach, w * half_width, h * half_height] for w, h in ((1, 1), (-1, 1), (-1, -1), (1, -1))])
    eye = np.zeros((4, 3))
    around = np.roll(corners, -1, axis=0)
    edges = np.concatenate((np.stack((eye, corners), axis=1), np.stack((corners, around), axis=1))).reshape(-1, 3)
    vertices = np.concatenate((np.zeros((1, 3)), corners)).astype(np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]], dtype=np.uint32)
    return edges, Solid(vertices, np.full((5, 3), [1.0, 0.72, 0.1], dtype=np.float32), faces)


def base_transform(pose: Pose2D) -> FloatArray:
    """Return the (4, 4) transform of the base frame to the map."""
    cos, sin = np.cos(pose.yaw), np.sin(pose.yaw)
    return np.array([[cos, -sin, 0, pose.x], [sin, cos, 0, pose.y], [0, 0, 1, 0], [0, 0, 0, 1]], dtype=np.float64)


def camera_transform(spec: CameraSpec, pan: float, tilt: float) -> FloatArray:
    """Return the (4, 4) transform of the frame of `camera` to the base frame."""
    cos_p, sin_p, cos_t, sin_t = np.cos(pan), np.sin(pan), np.cos(tilt), np.sin(tilt)
    turn = np.array([[cos_p, -sin_p, 0], [sin_p, cos_p, 0], [0, 0, 1]])
    nod = np.array([[cos_t, 0, -sin_t], [0, 1, 0], [sin_t, 0, cos_t]])
    transform = np.eye(4)
    transform[:3, :3] = turn @ nod
    transform[:3, 3] = spec.x, 0.0, spec.height
    return transform
