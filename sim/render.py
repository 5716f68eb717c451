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

from sim.render_parts import PLACE, PLANE, Parts, Visible
from sim.render_raster import Window, draw_part, draw_wall, rays_of
from sim.render_rays import CARRIES, FLOOR, NOTHING, SLACK, WALL, IntArray, Solids
from sim.render_resolve import choose
from sim.render_shade import SKY, TINT, floor_colour, part_colour, wall_colour
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
    hulls: IntArray,
) -> int:
    """Draw all that meets a window; returns how many layers hold something.

    Layer 0 are the walls, layer 1 is what carries nothing, each further layer is one carrier, noted in ``hulls``.
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
            layer, hulls[layers] = layers, thing[0]
            depths[layer, :height, :width] = math.inf
            layers += 1
        for row in range(thing[1], thing[2]):
            form = parts.forms[int(visible.rows[row, PLACE])]
            draw_part(visible.rows[row], form, row, window, xs, ys, depths[layer], numbers[layer])
    return layers


@_kernel
def _see(
    solids: Solids,
    parts: Parts,
    view: View,
    visible: Visible,
    x: float,
    y: float,
    i: int,
    j: int,
    depths: FloatArray,
    numbers: IntArray,
    layers: int,
) -> tuple[float, int, int]:
    """Return what a pixel sees: depth, surface, and the number of the part's row or of the wall's face."""
    r, eye = view.rotation, view.position[2]
    dz = r[2, 0] * x + r[2, 1] * y + r[2, 2]
    floor = -eye / dz if dz < 0.0 and eye > 0.0 else math.inf
    wall, face = depths[0, i, j], numbers[0, i, j]
    if eye > solids.room[3] and dz < 0.0:
        top = _wall_top(solids, view, x, y, (solids.room[3] - eye) / dz)
        if top < wall:
            wall, face = top, -1
    seen, nearest = 1, 1
    if layers > 2:
        seen, nearest = choose(solids, parts, visible, depths, numbers, layers, i, j, x, y)
    for layer in (seen, nearest):
        t = depths[layer, i, j]
        if t <= floor and t < math.inf:
            row = numbers[layer, i, j]
            thing = parts.owners[int(visible.rows[row, PLACE])]
            slack = solids.boxes[thing, SLACK] / math.sqrt(x * x + y * y + 1.0)
            if t - slack <= wall:
                return t, thing, row
    if wall < floor:
        return wall, WALL, face
    return (floor, FLOOR, 0) if floor < math.inf else (math.inf, NOTHING, 0)


@_kernel
def _wall_top(solids: Solids, view: View, x: float, y: float, t: float) -> float:
    """Return ``t`` if the ray comes down on a wall's top there, inf if not."""
    r, p, room = view.rotation, view.position, solids.room
    col = math.floor((p[0] + t * (r[0, 0] * x + r[0, 1] * y + r[0, 2]) - room[0]) / room[2])
    row = math.floor((p[1] + t * (r[1, 0] * x + r[1, 1] * y + r[1, 2]) - room[1]) / room[2])
    rows, cols = solids.clearance.shape
    return t if 0 <= row < rows and 0 <= col < cols and solids.clearance[row, col] == 0 else math.inf


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
    depths, numbers = np.empty((count, 1, 1)), np.empty((count, 1, 1), np.int32)
    hulls = np.empty(count, np.int32)
    for k in range(len(pixels)):
        col, row = pixels[k]
        window = (int(col), int(row), int(col) + 1, int(row) + 1)
        layers = _draw(solids, parts, view, visible, window, xs, ys, depths, numbers, hulls)
        t, _, _ = _see(solids, parts, view, visible, xs[col], ys[row], 0, 0, depths, numbers, layers)
        out[k] = _reading(t, depth_range)


@_kernel
def _render(
    solids: Solids,
    parts: Parts,
    room: FloatArray,
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
    numbers, hulls = np.zeros((count, _TILE_HEIGHT, _TILE_WIDTH), np.int32), np.empty(count, np.int32)
    for top in range(window[1], window[3], _TILE_HEIGHT):
        for left in range(window[0], window[2], _TILE_WIDTH):
            right, bottom = min(left + _TILE_WIDTH, window[2]), min(top + _TILE_HEIGHT, window[3])
            tile = (left, top, right, bottom)
            layers = _draw(solids, parts, view, visible, tile, xs, ys, depths, numbers, hulls)
            for v in range(top, bottom):
                for u in range(left, right):
                    x, y = xs[u], ys[v]
                    t, surface, number = _see(
                        solids, parts, view, visible, x, y, v - top, u - left, depths, numbers, layers
                    )
                    i, j = v - window[1], u - window[0]
                    depth[i, j], surfaces[i, j] = _reading(t, depth_range), surface
                    colour = _colour(solids, parts, room, view, visible, x, y, t, surface, number)
                    for k in range(3):
                        rgb[i, j, k] = np.uint8(min(max(colour[k], 0.0), 255.0))


@_kernel
def _colour(
    solids: Solids,
    parts: Parts,
    room: FloatArray,
    view: View,
    visible: Visible,
    x: float,
    y: float,
    t: float,
    surface: int,
    number: int,
) -> tuple[float, float, float]:
    """Return the colour of what a pixel sees."""
    if surface == NOTHING:
        return room[SKY] * room[TINT], room[SKY + 1] * room[TINT + 1], room[SKY + 2] * room[TINT + 2]
    r, p, pixel = view.rotation, view.position, t / view.fx
    dx = r[0, 0] * x + r[0, 1] * y + r[0, 2]
    dy = r[1, 0] * x + r[1, 1] * y + r[1, 2]
    dz = r[2, 0] * x + r[2, 1] * y + r[2, 2]
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if surface == FLOOR:  # a pixel is stretched where the floor is seen at a slant
        return floor_colour(room, p[0] + t * dx, p[1] + t * dy, pixel * max(0.5 * length / abs(dz), 1.0))
    if surface == WALL:
        if number < 0:
            return wall_colour(room, 5, p[0] + t * dx, p[1] + t * dy, pixel)
        side = int(visible.walls[number, PLANE])
        along = p[1] + t * dy if side < 2 else p[0] + t * dx
        return wall_colour(room, side, along, p[2] + t * dz, pixel)
    part = int(visible.rows[number, PLACE])
    toward = (-dx / length, -dy / length, -dz / length)
    return part_colour(
        visible.rows[number],
        parts.forms[part],
        parts.inverses[part],
        parts.paints[part],
        room,
        x,
        y,
        t,
        view.fx,
        toward,
    )
