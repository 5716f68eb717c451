"""Colour, depth and identity images of a scene.

A window of the image is cut into tiles. For each tile the faces of walls and the parts of things are drawn into
buffers that keep the nearest depth; then each pixel gets what it sees, and only that is shaded. Furniture that carries
something has a buffer of its own, as it is open towards what it carries (`sim.render_rays` has the rules).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.render_parts import PLACE, RECT, Parts, Visible
from sim.render_raster import Window, draw_part, draw_wall, points_on_part, points_on_wall
from sim.render_rays import CARRIES, IntArray, Solids
from sim.render_resolve import COMMON_LAYER, WALL_LAYER, resolve
from sim.render_shade import shade_parts, shade_room
from sim.scene import Scene
from sim.visibility import View
from zavis_bt.types import FloatArray

_TILE_WIDTH, _TILE_HEIGHT = 64, 32  # [px]; its buffers stay in the processor's cache

_kernel = njit(cache=True, nogil=True, error_model="numpy")


class Picture(NamedTuple):
    """A rendered window."""

    rgb: NDArray[np.uint8]
    """(h, w, 3)"""
    depth: NDArray[np.float32]
    """(h, w) [m]; 0 = no reading."""
    surfaces: IntArray
    """(h, w) index of the thing in `Scene.things`, or `FLOOR`, `WALL`, `NOTHING` of `sim.render_rays`."""


def render(
    scene: Scene, view: View, visible: Visible, window: tuple[int, int, int, int], depth_range: tuple[float, float]
) -> Picture:
    """Render a window of the image.

    Args:
        scene: What there is to see.
        view: The camera.
        visible: What the view may show of the scene.
        window: First column, first row, end column and end row of the wanted pixels.
        depth_range: Least and greatest depth the camera measures [m].
    """
    shape = window[3] - window[1], window[2] - window[0]
    picture = Picture(np.empty((*shape, 3), np.uint8), np.empty(shape, np.float32), np.empty(shape, np.int32))
    _render(scene.solids, scene.parts, scene.room_paint, view, visible, window, depth_range, *picture)
    for array in picture:
        array.setflags(write=False)
    return picture


def measure(
    scene: Scene, view: View, visible: Visible, pixels: NDArray[np.intp], depth_range: tuple[float, float]
) -> NDArray[np.float32]:
    """Return the depths (n,) at (n, 2) pixels ``[column, row]``, the same as in the image `render` makes."""
    depths = np.empty(len(pixels), dtype=np.float32)
    _measure(scene.solids, scene.parts, view, visible, np.asarray(pixels, dtype=np.int64), depth_range, depths)
    return depths


@_kernel
def _reading(depth: float, depth_range: tuple[float, float]) -> float:
    return depth if depth_range[0] <= depth <= depth_range[1] else 0.0


@_kernel
def _draw(
    solids: Solids,
    parts: Parts,
    view: View,
    visible: Visible,
    window: Window,
    pixels: NDArray[np.int64],
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
) -> int:
    """Draw all that meets a window, or only some pixels of it if there are any given.

    Returns how many layers hold something. Layer 0 are the walls, layer 1 is what carries nothing, each further layer
    is one carrier.
    """
    left, top, right, bottom = window
    rows, walls, things, forms, single = visible.rows, visible.walls, visible.things, parts.forms, len(pixels) > 0
    height, width = xs.shape
    _clear(depths, WALL_LAYER, height, width)
    _clear(depths, COMMON_LAYER, height, width)
    for k in range(len(walls)):
        if walls[k, 0] < right and walls[k, 1] < bottom and walls[k, 2] > left and walls[k, 3] > top:
            if single:
                points_on_wall(walls, k, solids.room[3], view, pixels, xs, ys, depths, numbers, WALL_LAYER)
            else:
                draw_wall(walls[k], solids.room[3], k, view, window, xs, ys, depths[WALL_LAYER], numbers[WALL_LAYER])
    layers = COMMON_LAYER + 1
    for k in range(len(things)):
        if things[k, 3] >= right or things[k, 4] >= bottom or things[k, 5] <= left or things[k, 6] <= top:
            continue
        layer = COMMON_LAYER
        if solids.boxes[things[k, 0], CARRIES] > 0.0:
            layer = layers
            _clear(depths, layer, height, width)
            layers += 1
        for row in range(things[k, 1], things[k, 2]):
            across = rows[row, RECT] < right and rows[row, RECT + 2] > left
            if across and rows[row, RECT + 1] < bottom and rows[row, RECT + 3] > top:
                part = int(rows[row, PLACE])
                if single:
                    points_on_part(rows, row, forms, part, pixels, xs, ys, depths, numbers, layer)
                else:
                    draw_part(rows[row], forms[part], row, window, xs, ys, depths[layer], numbers[layer])
    return layers


@_kernel
def _clear(depths: FloatArray, layer: int, height: int, width: int) -> None:
    for i in range(height):
        for j in range(width):
            depths[layer, i, j] = math.inf


@_kernel
def _carriers(solids: Solids, visible: Visible) -> int:
    count = 0
    for k in range(len(visible.things)):
        count += 1 if solids.boxes[visible.things[k, 0], CARRIES] > 0.0 else 0
    return count


@_kernel
def _measure(
    solids: Solids,
    parts: Parts,
    view: View,
    visible: Visible,
    pixels: NDArray[np.int64],
    depth_range: tuple[float, float],
    out: NDArray[np.float32],
) -> None:
    n = len(pixels)
    if n == 0:
        return
    xs, ys, seen = np.empty((n, 1)), np.empty((n, 1)), np.empty((n, 1))
    surfaces, whose = np.empty((n, 1), np.int32), np.empty((n, 1), np.int32)
    window = (pixels[:, 0].min(), pixels[:, 1].min(), pixels[:, 0].max() + 1, pixels[:, 1].max() + 1)
    for k in range(n):
        xs[k, 0], ys[k, 0] = (pixels[k, 0] + 0.5 - view.cx) / view.fx, (pixels[k, 1] + 0.5 - view.cy) / view.fy
    count = _carriers(solids, visible) + 2
    depths, numbers = np.empty((count, n, 1)), np.zeros((count, n, 1), np.int32)
    layers = _draw(solids, parts, view, visible, window, pixels, xs, ys, depths, numbers)
    resolve(solids, parts, view, visible, (n, 1), xs, ys, depths, numbers, layers, seen, surfaces, whose)
    for k in range(n):
        out[k] = _reading(seen[k, 0], depth_range)


@_kernel
def _render(
    solids: Solids,
    parts: Parts,
    look: FloatArray,
    view: View,
    visible: Visible,
    window: Window,
    depth_range: tuple[float, float],
    rgb: NDArray[np.uint8],
    depth: NDArray[np.float32],
    surfaces: IntArray,
) -> None:
    count, shape = _carriers(solids, visible) + 2, (_TILE_HEIGHT, _TILE_WIDTH)
    depths, numbers = np.empty((count, *shape)), np.zeros((count, *shape), np.int32)
    seen, colours, no_pixels = np.empty(shape), np.empty((*shape, 3)), np.empty((0, 2), np.int64)
    what, whose, xs, ys = np.empty(shape, np.int32), np.empty(shape, np.int32), np.empty(shape), np.empty(shape)
    for top in range(window[1], window[3], _TILE_HEIGHT):
        for left in range(window[0], window[2], _TILE_WIDTH):
            tile = (left, top, min(left + _TILE_WIDTH, window[2]), min(top + _TILE_HEIGHT, window[3]))
            size = (tile[3] - top, tile[2] - left)
            for i in range(size[0]):
                y = (top + i + 0.5 - view.cy) / view.fy
                for j in range(size[1]):
                    xs[i, j], ys[i, j] = (left + j + 0.5 - view.cx) / view.fx, y
            layers = _draw(solids, parts, view, visible, tile, no_pixels, xs, ys, depths, numbers)
            resolve(solids, parts, view, visible, size, xs, ys, depths, numbers, layers, seen, what, whose)
            shade_room(look, view, visible, size, xs, ys, seen, what, whose, colours)
            shade_parts(parts, look, view, visible, size, xs, ys, seen, what, whose, colours)
            for i in range(size[0]):
                v = top + i - window[1]
                for j in range(size[1]):
                    u = left + j - window[0]
                    depth[v, u], surfaces[v, u] = _reading(seen[i, j], depth_range), what[i, j]
                    for k in range(3):
                        rgb[v, u, k] = np.uint8(min(colours[i, j, k], 255.0))
