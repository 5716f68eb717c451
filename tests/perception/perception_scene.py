"""Frames of synthetic scenes, and a detector and a matcher that say what a test tells them to."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from zavis_bt.geometry import project, transform_camera_to_map
from zavis_bt.types import (
    UNKNOWN_CLASS,
    Box,
    CameraIntrinsics,
    CameraSpec,
    Detection,
    FloatArray,
    Pose2D,
    RgbdFrame,
)

INTRINSICS = CameraIntrinsics.from_fov(320, 240, math.radians(60))
ORIGIN = Pose2D(0.0, 0.0)
CAMERA = CameraSpec(INTRINSICS, x=0.0, height=1.0, depth_min=0.1, depth_max=8.0, rate=10.0)

Solid = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Lowest and highest corner of an axis-aligned block in the map [m]."""


def frame_of(solids: Sequence[Solid], base: Pose2D = ORIGIN, tilt: float = 0.0, floor: bool = True) -> RgbdFrame:
    """Return a frame of blocks on a floor, seen from the base's pose; no depth beyond 8 m."""
    transform = transform_camera_to_map(base, 0.0, tilt, CAMERA)

    def pixels() -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        depth = _render(solids, transform, floor)
        return np.zeros((*depth.shape, 3), dtype=np.uint8), depth

    return RgbdFrame(INTRINSICS, transform, 3.5, pixels)


def box_around(solid: Solid, frame: RgbdFrame) -> Box:
    """Return the box in the frame that just holds the block."""
    low, high = np.array(solid)
    corners = np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i, j, k in np.ndindex(2, 2, 2)])
    u, v, _ = project(corners, frame.transform_camera_to_map, frame.intrinsics).T
    return Box(float(u.min()), float(v.min()), float(u.max()), float(v.max()))


def _render(solids: Sequence[Solid], transform: FloatArray, floor: bool) -> NDArray[np.float32]:
    u, v = np.meshgrid(np.arange(INTRINSICS.width) + 0.5, np.arange(INTRINSICS.height) + 0.5)
    optical = np.stack(
        ((u - INTRINSICS.cx) / INTRINSICS.fx, (v - INTRINSICS.cy) / INTRINSICS.fy, np.ones_like(u)), axis=-1
    )
    rays, origin = optical @ transform[:3, :3].T, transform[:3, 3]
    rays = np.where(np.abs(rays) < 1e-12, 1e-12, rays)
    nearest = np.full(u.shape, np.inf)
    for low, high in (*solids, *([((-50.0, -50.0, -1.0), (50.0, 50.0, 0.0))] if floor else [])):
        a, b = (np.array(low) - origin) / rays, (np.array(high) - origin) / rays
        enter, leave = np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)
        nearest = np.where((enter <= leave) & (enter > 0), np.minimum(nearest, enter), nearest)
    return np.where(nearest < CAMERA.depth_max, nearest, 0.0).astype(np.float32)


class ScriptedDetector:
    """Returns the detections it was given."""

    def __init__(self, *detections: Detection) -> None:
        self._detections = detections

    def detect(self, frame: RgbdFrame) -> Sequence[Detection]:
        return self._detections


class ScriptedMatcher:
    """Returns a score for each box and text, by default 10, and counts its calls."""

    def __init__(self, scores: Mapping[Box, Mapping[str, float]] | None = None, default: float = 10.0) -> None:
        self._scores = scores or {}
        self._default = default
        self.calls: list[tuple[list[Box], list[str]]] = []

    def match(self, frame: RgbdFrame, boxes: Sequence[Box], texts: Sequence[str]) -> FloatArray:
        self.calls.append((list(boxes), list(texts)))
        return np.array([[self._scores.get(box, {}).get(text, self._default) for text in texts] for box in boxes])


def unknown(box: Box, score: float = 0.8) -> Detection:
    """Return a detection of something the detector does not know."""
    return Detection(box, UNKNOWN_CLASS, score)
