"""Colour, depth and identity images of a scene.

A window of the image is cut into tiles. For each tile the faces of walls and the parts of things are drawn into buffers
that keep the nearest depth; then each pixel gets what it sees, and only that is shaded. Furniture that carries something
in the tile has a buffer of its own, as it is open towards what it carries (`sim.render_rays` has the rules).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.render_parts import PLACE, Parts, Visible
from sim.render_raster import Window, draw_part, draw_wall, rays_of
from sim.render_rays import CARRIES, IntArray, Solids
from sim.render_resolve import resolve
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
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
) -> int:
    """Draw all that meets a window; returns how many layers hold something.

    Layer 0 are the walls, layer 1 is what carries nothing each further layer is one carrier.
    """
    width, height, layers = window[2] - window[0], window[3] - window[1], 2
    depths[:2, :height, :width] = math.inf
    for k in range(len(visible.walls)):
        draw_wall(visible.walls[k], solids.room[3], k, view, window, xs, ys, depths[0], numbers[0])
    for k in range(len(visible.things)):
        thing = visible.things[k]
        if thing[3] >= window[2] or thing[4] >= window[3] or thing[5] <= window[0] or thing[6] <= window[1]:
            continue
        layer = 1
        if solids.boxes[thing[0], CARRIES] > 0.0 and layers < len(depths):
            layer = layers
            depths[layer, :height, :width] = math.inf
            layers += 1
        for row in range(thing[1], thing[2]):
            form = parts.forms[int(visible.rows[row, PLACE])]
            draw_part(visible.rows[row], form, row, window, xs, ys, depths[layer], numbers[layer])
    return layers


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
    xs, ys = rays_of(view)
    count = _carriers(solids, visible) + 2
    depths, numbers = np.empty((count, 1, 1)), np.zeros((count, 1, 1), np.int32)
    seen, surfaces, whose = np.empty((1, 1)), np.empty((1, 1), np.int32), np.empty((1, 1), np.int32)
    for k in range(len(pixels)):
        col, row = int(pixels[k, 0]), int(pixels[k, 1])
        tile = (col, row, col + 1, row + 1)
        layers = _draw(solids, parts, view, visible, tile, xs, ys, depths, numbers)
        resolve(solids, parts, view, visible, tile, xs, ys, depths, numbers, layers, seen, surfaces, whose)
        out[k] = _reading(seen[0, 0], depth_range)


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
    xs, ys = rays_of(view)
    count = _carriers(solids, visible) + 2
    depths = np.empty((count, _TILE_HEIGHT, _TILE_WIDTH))
    numbers = np.zeros((count, _TILE_HEIGHT, _TILE_WIDTH), np.int32)
    seen, colours = np.empty((_TILE_HEIGHT, _TILE_WIDTH)), np.empty((_TILE_HEIGHT, _TILE_WIDTH, 3))
    what, whose = np.empty((_TILE_HEIGHT, _TILE_WIDTH), np.int32), np.empty((_TILE_HEIGHT, _TILE_WIDTH), np.int32)
    for top in range(window[1], window[3], _TILE_HEIGHT):
        for left in range(window[0], window[2], _TILE_WIDTH):
            tile = (left, top, min(left + _TILE_WIDTH, window[2]), min(top + _TILE_HEIGHT, window[3]))
            layers = _draw(solids, parts, view, visible, tile, xs, ys, depths, numbers)
            resolve(solids, parts, view, visible, tile, xs, ys, depths, numbers, layers, seen, what, whose)
            shade_room(look, view, visible, tile, xs, ys, seen, what, whose, colours)
            shade_parts(parts, look, view, visible, tile, xs, ys, seen, what, whose, colours)
            for i in range(tile[3] - top):
                v = top + i - window[1]
                for j in range(tile[2] - left):
                    u = left + j - window[0]
                    depth[v, u], surfaces[v, u] = _reading(seen[i, j], depth_range), what[i, j]
                    for k in range(3):
                        rgb[v, u, k] = np.uint8(min(colours[i, j, k], 255.0))
