"""Colour and depth images of a scene.

The image is cut into tiles; a pixel's ray is tried only against the boxes whose rectangle meets its tile. The ray goes
through the same kernel as any other ray, so an image holds exactly what single rays measure.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.render_rays import COS, CX, CY, CZ, FLOOR, HX, SIN, WALL, IntArray, Ray, Solids, first_hit
from sim.scene import Scene
from sim.visibility import Bounds, View
from zavis_bt.types import FloatArray

_TILE = 16  # [px]
_FLOOR_TILE = 0.4  # [m]
_EDGE, _EDGE_SHARE = 0.012, 0.04  # width of a box's dark edges [m], at most this share of the face
_EDGE_SHADE = 0.72
_FLOOR_PAINT, _SKY_PAINT = 6, 8  # rows of `room_paint`


def render(
    scene: Scene, view: View, bounds: Bounds, window: tuple[int, int, int, int], depth_range: tuple[float, float]
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Render a window of the image.

    Args:
        scene: What there is to see.
        view: The camera.
        bounds: Where the scene's boxes lie in the image.
        window: First column, first row, end column and end row of the wanted pixels.
        depth_range: Least and greatest depth the camera measures [m].

    Returns:
        rgb (h, w, 3) and depth (h, w) of the window; see `zavis_bt.types.RgbdFrame`.
    """
    shape = window[3] - window[1], window[2] - window[0]
    rgb, depth = np.empty((*shape, 3), dtype=np.uint8), np.empty(shape, dtype=np.float32)
    _render(scene.solids, view, bounds, scene.paints, window, depth_range, rgb, depth)
    rgb.setflags(write=False)
    depth.setflags(write=False)
    return rgb, depth


def measure(
    scene: Scene, view: View, bounds: Bounds, pixels: NDArray[np.intp], depth_range: tuple[float, float]
) -> NDArray[np.float32]:
    """Return the depths (n,) at (n, 2) pixels ``[column, row]``, the same as in the image `render` makes."""
    depths = np.empty(len(pixels), dtype=np.float32)
    _measure(scene.solids, view, bounds, np.ascontiguousarray(pixels, dtype=np.int64), depth_range, depths)
    return depths


@njit(cache=True, nogil=True, error_model="numpy")
def _pixel_ray(view: View, col: int, row: int) -> Ray:
    """Return the ray through a pixel's centre, map frame, optical depth 1."""
    x, y, r, p = (col + 0.5 - view.cx) / view.fx, (row + 0.5 - view.cy) / view.fy, view.rotation, view.position
    return (
        p[0],
        p[1],
        p[2],
        r[0, 0] * x + r[0, 1] * y + r[0, 2],
        r[1, 0] * x + r[1, 1] * y + r[1, 2],
        r[2, 0] * x + r[2, 1] * y + r[2, 2],
    )


@njit(cache=True, nogil=True)
def _collect(bounds: Bounds, x0: float, y0: float, x1: float, y1: float, ids: IntArray) -> int:
    """Collect the boxes whose rectangle comes within a pixel of an image region; returns their number."""
    count = 0
    for k in range(len(bounds.inside)):
        box = bounds.inside[k]
        rectangle = bounds.rectangles[box]
        across = rectangle[0] - 1.0 <= x1 and rectangle[2] + 1.0 >= x0
        if across and rectangle[1] - 1.0 <= y1 and rectangle[3] + 1.0 >= y0:
            ids[count] = box
            count += 1
    return count


@njit(cache=True, nogil=True)
def _reading(depth: float, depth_range: tuple[float, float]) -> float:
    return depth if depth_range[0] <= depth <= depth_range[1] else 0.0


@njit(cache=True, nogil=True)
def _measure(
    solids: Solids,
    view: View,
    bounds: Bounds,
    pixels: NDArray[np.int64],
    depth_range: tuple[float, float],
    depths: NDArray[np.float32],
) -> None:
    boxes, hulls, clearance, room = solids
    size = len(bounds.inside)
    ids, hits, entries = np.empty(size, np.int32), np.empty((size, 2), np.int32), np.empty(size)
    for i in range(len(pixels)):
        col, row = pixels[i]
        count = _collect(bounds, col, row, col + 1, row + 1, ids)
        ray = _pixel_ray(view, col, row)
        depth, _, _ = first_hit(boxes, hulls, clearance, room, ray, ids, count, hits, entries)
        depths[i] = _reading(depth, depth_range)


@njit(cache=True, nogil=True)
def _render(
    solids: Solids,
    view: View,
    bounds: Bounds,
    paints: NDArray[np.uint8],
    window: tuple[int, int, int, int],
    depth_range: tuple[float, float],
    rgb: NDArray[np.uint8],
    depth: NDArray[np.float32],
) -> None:
    boxes, hulls, clearance, room = solids
    size = len(bounds.inside)
    ids, hits, entries = np.empty(size, np.int32), np.empty((size, 2), np.int32), np.empty(size)
    first_col, first_row, end_col, end_row = window
    room_row = 6 * len(boxes)
    for top in range(first_row, end_row, _TILE):
        for left in range(first_col, end_col, _TILE):
            right, bottom = min(left + _TILE, end_col), min(top + _TILE, end_row)
            count = _collect(bounds, left, top, right, bottom, ids)
            for row in range(top, bottom):
                for col in range(left, right):
                    ray = _pixel_ray(view, col, row)
                    t, surface, face = first_hit(boxes, hulls, clearance, room, ray, ids, count, hits, entries)
                    depth[row - first_row, col - first_col] = _reading(t, depth_range)
                    x, y, z = ray[0] + t * ray[3], ray[1] + t * ray[4], ray[2] + t * ray[5]
                    shade = _edge_shade(boxes, surface, face, x, y, z) if surface >= 0 else 1.0
                    paint = surface * 6 + face if surface >= 0 else _room_row(surface, face, x, y, room_row)
                    for k in range(3):
                        rgb[row - first_row, col - first_col, k] = np.uint8(paints[paint, k] * shade)


@njit(cache=True, nogil=True)
def _room_row(surface: int, face: int, x: float, y: float, first: int) -> int:
    """Return the row of the paints for what is not a box; `room_paint` begins at row ``first``."""
    if surface == WALL:
        return first + face
    if surface == FLOOR and math.isfinite(x) and math.isfinite(y):
        return first + _FLOOR_PAINT + (math.floor(x / _FLOOR_TILE) + math.floor(y / _FLOOR_TILE)) % 2
    return first + _SKY_PAINT


@njit(cache=True, nogil=True)
def _edge_shade(boxes: FloatArray, box: int, face: int, x: float, y: float, z: float) -> float:
    """Return how bright a point of a face is: dark near the edges, so that boxes show their shape."""
    cos, sin = boxes[box, COS], boxes[box, SIN]
    rx, ry = x - boxes[box, CX], y - boxes[box, CY]
    for axis in range(3):
        if axis == face // 2:
            continue
        place = abs(cos * rx + sin * ry if axis == 0 else cos * ry - sin * rx if axis == 1 else z - boxes[box, CZ])
        half = boxes[box, HX + axis]
        if half - place < min(_EDGE, _EDGE_SHARE * half):
            return _EDGE_SHADE
    return 1.0
