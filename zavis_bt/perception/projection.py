"""Where the thing inside an image box is in the map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.geometry import back_project, transform_points
from zavis_bt.types import Box, CameraIntrinsics, FloatArray, RgbdFrame

_GRID = 7  # samples along each side of a box
_LANDMARK_SPAN = 0.9  # share of a landmark's box that is sampled: its very edge is background
_OBJECT_SPAN = 0.6  # the same for an object, of which the middle is the surest
_FLOOR = 0.05  # below this height a point belongs to the floor, not to furniture [m]
_GAP = 0.1  # depths that lie further apart belong to different things [m] …
_RELATIVE_GAP = 0.03  # … or by this share of the distance, as depth cameras grow noisy with it
_MIN_DEPTH_OF_LANDMARK = 0.3  # half the depth granted to the narrowest landmark [m]
_MIN_SHARE = 0.15  # smaller clusters of depth in the middle of an object's box are noise or a thin occluder


@dataclass(frozen=True, slots=True)
class Located:
    """Where the visible surface of something is."""

    position: tuple[float, float, float]
    """Middle of the surface, map frame [m]."""
    radius: float
    """Half its horizontal extent [m]."""
    depth: float
    """Distance of the surface along the optical axis [m]."""


def locate_landmark(frame: RgbdFrame, box: Box) -> Located | None:
    """Locate a piece of furniture that fills most of its box.

    The median depth in the box's middle decides. Points of the floor do not count, nor do those further in front of
    or behind it than half the box's width, as furniture seldom is deeper than wide.

    Args:
        frame: The frame the box is from; its own depth and camera pose are used.
        box: Box in that frame [px].

    Returns:
        The surface, its middle halfway between its ends, or None if the box has no depth.
    """
    pixels = _sample(box, frame.intrinsics, _LANDMARK_SPAN)
    depth, points = _points(frame, pixels)
    seen = depth > 0
    upright = seen & (points[:, 2] > _FLOOR)
    seen = upright if upright.any() else seen
    if not seen.any():
        return None
    central = seen & _inside(pixels, box, _OBJECT_SPAN)
    reference = float(np.percentile(depth[central if central.any() else seen], 50, method="lower"))
    tolerance = max((box.x1 - box.x0) * reference / frame.intrinsics.fx / 2, _MIN_DEPTH_OF_LANDMARK)
    surface = points[seen & (np.abs(depth - reference) <= tolerance)]
    low, high = np.percentile(surface, (5, 95), axis=0)
    return _located((low + high) / 2, surface, _LANDMARK_SPAN, reference)


def locate_object(frame: RgbdFrame, box: Box) -> Located | None:
    """Locate an object whose box also shows what is behind it.

    Depths in the box's middle are split where they leave a gap; the nearest cluster that is not just noise is the
    object.

    Args:
        frame: The frame the box is from; its own depth and camera pose are used.
        box: Box in that frame [px].

    Returns:
        The surface, its middle the median, or None if the box has no depth.
    """
    pixels = _sample(box, frame.intrinsics, _OBJECT_SPAN)
    depth, points = _points(frame, pixels)
    seen = np.flatnonzero(depth > 0)
    if not len(seen):
        return None
    order = seen[np.argsort(depth[seen], kind="stable")]
    gap = np.maximum(_GAP, _RELATIVE_GAP * depth[order[:-1]])
    clusters = np.split(order, np.flatnonzero(np.diff(depth[order]) > gap) + 1)
    needed = min(_MIN_SHARE * len(seen), max(map(len, clusters)))
    nearest = next(cluster for cluster in clusters if len(cluster) >= needed)
    surface = points[nearest]
    return _located(np.median(surface, axis=0), surface, _OBJECT_SPAN, float(np.median(depth[nearest])))


def _located(middle: FloatArray, surface: FloatArray, span: float, depth: float) -> Located:
    x, y, z = middle.tolist()
    return Located((x, y, z), _extent(surface[:, :2]) / span / 2, depth)


def _sample(box: Box, intrinsics: CameraIntrinsics, span: float) -> NDArray[np.intp]:
    """Return the distinct pixels (n, 2) ``[column, row]`` of a grid over the box's middle, inside the image."""
    steps = np.linspace(-span / 2, span / 2, _GRID)
    columns = (box.x0 + box.x1) / 2 + steps * (box.x1 - box.x0)
    rows = (box.y0 + box.y1) / 2 + steps * (box.y1 - box.y0)
    column = np.unique(np.clip(np.floor(columns), 0, intrinsics.width - 1).astype(np.intp))
    row = np.unique(np.clip(np.floor(rows), 0, intrinsics.height - 1).astype(np.intp))
    return np.stack(np.meshgrid(column, row), axis=-1).reshape(-1, 2)


def _points(frame: RgbdFrame, pixels: NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
    """Return depth (n,) [m], 0 where there is no reading, and map points (n, 3) [m] of the pixels."""
    depth = np.asarray(frame.depth_at(pixels), dtype=np.float64)
    depth = np.where(np.isfinite(depth) & (depth > 0), depth, 0.0)
    optical = back_project(pixels.astype(np.float64) + 0.5, depth, frame.intrinsics)
    return depth, transform_points(frame.transform_camera_to_map, optical)


def _inside(pixels: NDArray[np.intp], box: Box, span: float) -> NDArray[np.bool_]:
    """Return which pixels (n, 2) lie in the middle part of the box."""
    middle = np.array([box.x0 + box.x1, box.y0 + box.y1]) / 2
    size = np.array([box.x1 - box.x0, box.y1 - box.y0])
    offset = np.abs(pixels.astype(np.float64) + 0.5 - middle)
    return np.all(offset <= span / 2 * size + 1, axis=1)


def _extent(points: FloatArray) -> float:
    """Return the length of (n, 2) points along their principal axis [m]."""
    centred = points - points.mean(axis=0)
    along = centred @ np.linalg.eigh(centred.T @ centred)[1][:, -1]
    return float(along.max() - along.min())
