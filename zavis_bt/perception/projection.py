"""Where the thing inside an image box is in the map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

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
    pixels = _sample_box(box, frame.intrinsics, _LANDMARK_SPAN)
    width = (box.x1 - box.x0) / frame.intrinsics.fx
    return _as_located(_landmark_surface(*_points(frame, pixels), width), _LANDMARK_SPAN)


def locate_object(frame: RgbdFrame, box: Box) -> Located | None:
    """Locate an object whose box also shows what is behind it.

    The nearest thing in the box's middle that is more than noise is the object.

    Args:
        frame: The frame the box is from; its own depth and camera pose are used.
        box: Box in that frame [px].

    Returns:
        The surface, its middle the median, or None if the box has no depth.
    """
    pixels = _sample_box(box, frame.intrinsics, _OBJECT_SPAN)
    return _as_located(_object_surface(*_points(frame, pixels)), _OBJECT_SPAN)


def _as_located(surface: tuple[float, float, float, float, float], span: float) -> Located | None:
    x, y, z, extent, depth = surface
    return Located((x, y, z), extent / span / 2, depth) if depth > 0 else None


def _sample_box(box: Box, intrinsics: CameraIntrinsics, span: float) -> NDArray[np.intp]:
    return _sample(box.x0, box.y0, box.x1, box.y1, intrinsics.width, intrinsics.height, span)


def _points(frame: RgbdFrame, pixels: NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
    """Return depth (n,) [m], 0 where there is no reading, and map points (n, 3) [m] of the pixels."""
    depth = np.array(frame.depth_at(pixels), dtype=np.float64)  # our own copy: no reading becomes 0 in it
    camera = frame.intrinsics
    return depth, _to_map(depth, pixels, camera.fx, camera.fy, camera.cx, camera.cy, frame.transform_camera_to_map)


@njit(cache=True, nogil=True)
def _sample(x0: float, y0: float, x1: float, y1: float, width: int, height: int, span: float) -> NDArray[np.intp]:
    """Return the distinct pixels (n, 2) ``[column, row]`` of a grid over the box's middle, inside the image."""
    pixels = np.empty((_GRID * _GRID, 2), dtype=np.intp)
    n, last_row = 0, -1
    for i in range(_GRID):
        step = span * (i / (_GRID - 1) - 0.5)
        row = min(max(int(np.floor((y0 + y1) / 2 + step * (y1 - y0))), 0), height - 1)
        if row == last_row:
            continue
        last_row, last_column = row, -1
        for j in range(_GRID):
            step = span * (j / (_GRID - 1) - 0.5)
            column = min(max(int(np.floor((x0 + x1) / 2 + step * (x1 - x0))), 0), width - 1)
            if column != last_column:
                pixels[n, 0], pixels[n, 1] = column, row
                last_column = column
                n += 1
    return pixels[:n]


@njit(cache=True, nogil=True)
def _to_map(
    depth: FloatArray, pixels: NDArray[np.intp], fx: float, fy: float, cx: float, cy: float, transform: FloatArray
) -> FloatArray:
    """Return the map points of the pixels' centres; `depth` is set to 0 where it is no reading."""
    points = np.zeros((len(depth), 3))
    for i in range(len(depth)):
        z = depth[i]
        if not (np.isfinite(z) and z > 0):
            depth[i] = 0.0
            z = 0.0
        x, y = (pixels[i, 0] + 0.5 - cx) / fx * z, (pixels[i, 1] + 0.5 - cy) / fy * z
        for k in range(3):
            points[i, k] = transform[k, 0] * x + transform[k, 1] * y + transform[k, 2] * z + transform[k, 3]
    return points


@njit(cache=True, nogil=True)
def _nearest_thing(depth: FloatArray, seen: NDArray[np.bool_], gap: float, share: float) -> NDArray[np.intp]:
    """Return the indices of the nearest run of depths without a gap that holds a share of all that are seen."""
    order = np.flatnonzero(seen)
    order = order[np.argsort(depth[order], kind="mergesort")]
    starts = [0]
    for i in range(1, len(order)):
        if depth[order[i]] - depth[order[i - 1]] > max(gap, _RELATIVE_GAP * depth[order[i - 1]]):
            starts.append(i)
    starts.append(len(order))
    longest = 0
    for k in range(len(starts) - 1):
        longest = max(longest, starts[k + 1] - starts[k])
    needed = min(share * len(order), float(longest))
    for k in range(len(starts) - 1):
        if starts[k + 1] - starts[k] >= needed:
            return order[starts[k] : starts[k + 1]]
    return order


@njit(cache=True, nogil=True)
def _landmark_surface(depth: FloatArray, points: FloatArray, width: float) -> tuple[float, float, float, float, float]:
    """Return middle (x, y, z), horizontal extent and depth of a landmark; depth 0 if there is none."""
    upright = (depth > 0) & (points[:, 2] > _FLOOR)
    seen = upright if upright.any() else depth > 0
    if not seen.any():
        return 0.0, 0.0, 0.0, 0.0, 0.0
    reference = float(np.median(depth[_nearest_thing(depth, seen, _LANDMARK_GAP, _LANDMARK_SHARE)]))
    surface = points[seen & (np.abs(depth - reference) <= max(width * reference / 2, _LANDMARK_GAP))]
    middle = np.empty(3)
    for k in range(3):
        middle[k] = (np.percentile(surface[:, k], 5) + np.percentile(surface[:, k], 95)) / 2
    return middle[0], middle[1], middle[2], _extent(surface), reference


@njit(cache=True, nogil=True)
def _object_surface(depth: FloatArray, points: FloatArray) -> tuple[float, float, float, float, float]:
    """Return median (x, y, z), horizontal extent and depth of an object; depth 0 if there is none."""
    seen = depth > 0
    if not seen.any():
        return 0.0, 0.0, 0.0, 0.0, 0.0
    thing = _nearest_thing(depth, seen, _OBJECT_GAP, _OBJECT_SHARE)
    surface = points[thing]
    x, y, z = np.median(surface[:, 0]), np.median(surface[:, 1]), np.median(surface[:, 2])
    return x, y, z, _extent(surface), float(np.median(depth[thing]))


@njit(cache=True, nogil=True)
def _extent(points: FloatArray) -> float:
    """Return the horizontal length of (n, 3) points along their principal axis [m]."""
    x, y = points[:, 0] - points[:, 0].mean(), points[:, 1] - points[:, 1].mean()
    axis = 0.5 * np.arctan2(2 * (x * y).sum(), (x * x).sum() - (y * y).sum())
    along = x * np.cos(axis) + y * np.sin(axis)
    return float(along.max() - along.min())
