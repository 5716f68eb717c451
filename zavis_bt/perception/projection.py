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
_LANDMARK_GAP = 0.3  # depths that lie further apart belong to different things [m]
_OBJECT_GAP = 0.1
_RELATIVE_GAP = 0.03  # the least gap as a share of the distance, as depth cameras grow noisy with it
_LANDMARK_SHARE = 0.2  # share of the samples that makes a thing; less is noise or a thin occluder
_OBJECT_SHARE = 0.15


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

    The nearest thing that fills a good part of the box is the landmark, as legs of tables leave more of the box to
    what is behind. Points of the floor do not count, nor do those further in front or behind than half the box's
    width, as furniture seldom is deeper than wide.

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
    reference = float(np.median(depth[_nearest_thing(depth, seen, _LANDMARK_GAP, _LANDMARK_SHARE)]))
    tolerance = max((box.x1 - box.x0) * reference / frame.intrinsics.fx / 2, _LANDMARK_GAP)
    surface = points[seen & (np.abs(depth - reference) <= tolerance)]
    low, high = np.percentile(surface, (5, 95), axis=0)
    return _located((low + high) / 2, surface, _LANDMARK_SPAN, reference)


def locate_object(frame: RgbdFrame, box: Box) -> Located | None:
    """Locate an object whose box also shows what is behind it.

    The nearest thing in the box's middle that is more than noise is the object.

    Args:
        frame: The frame the box is from; its own depth and camera pose are used.
        box: Box in that frame [px].

    Returns:
        The surface, its middle the median, or None if the box has no depth.
    """
    pixels = _sample(box, frame.intrinsics, _OBJECT_SPAN)
    depth, points = _points(frame, pixels)
    seen = depth > 0
    if not seen.any():
        return None
    thing = _nearest_thing(depth, seen, _OBJECT_GAP, _OBJECT_SHARE)
    return _located(np.median(points[thing], axis=0), points[thing], _OBJECT_SPAN, float(np.median(depth[thing])))


def _nearest_thing(depth: FloatArray, seen: NDArray[np.bool_], gap: float, share: float) -> NDArray[np.intp]:
    """Return the indices of the nearest run of depths without a gap that holds a share of all that are seen."""
    order = np.flatnonzero(seen)
    order = order[np.argsort(depth[order], kind="stable")]
    least = np.maximum(gap, _RELATIVE_GAP * depth[order[:-1]])
    runs = np.split(order, np.flatnonzero(np.diff(depth[order]) > least) + 1)
    needed = min(share * len(order), max(map(len, runs)))
    return next(run for run in runs if len(run) >= needed)


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


def _extent(points: FloatArray) -> float:
    """Return the length of (n, 2) points along their principal axis [m]."""
    centred = points - points.mean(axis=0)
    along = centred @ np.linalg.eigh(centred.T @ centred)[1][:, -1]
    return float(along.max() - along.min())
