"""What each pixel of a tile sees: of walls, floor and things before one another.

The loops index arrays themselves: a call that takes arrays, once a pixel, would spend more time on counting references
to them than on its work.
"""

from __future__ import annotations

import math

from numba import njit

from sim.render_parts import PLACE, Parts, Visible
from sim.render_rays import CZ, FLOOR, HZ, NOTHING, SLACK, WALL, IntArray, Solids
from sim.visibility import View
from zavis_bt.types import FloatArray

WALL_LAYER, COMMON_LAYER = 0, 1
"""Layers of the buffers: walls; things that carry nothing. Each further one is one carrier's."""
WALL_TOP = -1
"""Number of a wall's face that is no vertical one."""

_UNDERSIDE = 0.12  # share of its height up to which a thing seen from below shows its underside

_kernel = njit(cache=True, nogil=True, error_model="numpy")


@_kernel
def resolve(
    solids: Solids,
    parts: Parts,
    view: View,
    visible: Visible,
    shape: tuple[int, int],
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
    layers: int,
    seen: FloatArray,
    surfaces: IntArray,
    whose: IntArray,
) -> None:
    """Find what the pixels of a tile see.

    Args:
        solids: Of the scene.
        parts: Of the scene.
        view: The camera.
        visible: What it may show.
        shape: Height and width of the tile.
        xs: (h, w) of the pixels' rays at optical depth 1.
        ys: (h, w) of the pixels' rays at optical depth 1.
        depths: Nearest depth in each layer.
        numbers: The wall's face or the part's row it belongs to.
        layers: How many layers hold something.
        seen: Gets the depth.
        surfaces: Gets what it is.
        whose: Gets the number of the wall's face or of the part's row.
    """
    _background(solids, view, shape, xs, ys, depths[WALL_LAYER], numbers[WALL_LAYER], seen, surfaces, whose)
    if layers == COMMON_LAYER + 1:
        _things(solids, parts, visible, shape, xs, ys, depths, numbers, seen, surfaces, whose)
    else:
        _things_on_carriers(solids, parts, view, visible, shape, xs, ys, depths, numbers, layers, seen, surfaces, whose)


@_kernel
def _background(
    solids: Solids,
    view: View,
    shape: tuple[int, int],
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
    seen: FloatArray,
    surfaces: IntArray,
    whose: IntArray,
) -> None:
    """Fill in walls, floor and nothing; the walls' depth stays as it is in ``depths`` but for tops of walls."""
    eye, height = view.position[2], solids.room[3]
    a, b, c = view.rotation[2, 0], view.rotation[2, 1], view.rotation[2, 2]
    for i in range(shape[0]):
        for j in range(shape[1]):
            steep = a * xs[i, j] + b * ys[i, j] + c
            floor = -eye / steep if steep < 0.0 and eye > 0.0 else math.inf
            wall = depths[i, j]
            seen[i, j] = min(wall, floor)
            surfaces[i, j] = WALL if wall < floor else FLOOR if floor < math.inf else NOTHING
            whose[i, j] = numbers[i, j]
    if eye > height:
        _wall_tops(solids, view, shape, xs, ys, depths, seen, surfaces, whose)


@_kernel
def _wall_tops(
    solids: Solids,
    view: View,
    shape: tuple[int, int],
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    seen: FloatArray,
    surfaces: IntArray,
    whose: IntArray,
) -> None:
    """Fill in tops of walls for a camera above them."""
    p, r, room = view.position, view.rotation, solids.room
    rows, cols = solids.clearance.shape
    for i in range(shape[0]):
        for j in range(shape[1]):
            x, y = xs[i, j], ys[i, j]
            steep = r[2, 0] * x + r[2, 1] * y + r[2, 2]
            if steep >= 0.0:
                continue
            t = (room[3] - p[2]) / steep
            col = math.floor((p[0] + t * (r[0, 0] * x + r[0, 1] * y + r[0, 2]) - room[0]) / room[2])
            row = math.floor((p[1] + t * (r[1, 0] * x + r[1, 1] * y + r[1, 2]) - room[1]) / room[2])
            inside = 0 <= row < rows and 0 <= col < cols
            if inside and t < seen[i, j] and solids.clearance[row, col] == 0:
                depths[i, j] = seen[i, j] = t
                surfaces[i, j], whose[i, j] = WALL, WALL_TOP


@_kernel
def _things(
    solids: Solids,
    parts: Parts,
    visible: Visible,
    shape: tuple[int, int],
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
    seen: FloatArray,
    surfaces: IntArray,
    whose: IntArray,
) -> None:
    """Put the nearest thing before the background, where no thing in the tile carries another."""
    owners, rows, boxes = parts.owners, visible.rows, solids.boxes
    for i in range(shape[0]):
        for j in range(shape[1]):
            t = depths[COMMON_LAYER, i, j]
            if t == math.inf:
                continue
            thing = owners[int(rows[numbers[COMMON_LAYER, i, j], PLACE])]
            floor = seen[i, j] if surfaces[i, j] == FLOOR else math.inf
            x, y = xs[i, j], ys[i, j]
            slack = boxes[thing, SLACK]
            slack = slack / math.sqrt(x * x + y * y + 1.0) if slack > 0.0 else 0.0
            if t <= floor and t - slack <= depths[WALL_LAYER, i, j]:
                seen[i, j], surfaces[i, j], whose[i, j] = t, thing, numbers[COMMON_LAYER, i, j]


@_kernel
def _things_on_carriers(
    solids: Solids,
    parts: Parts,
    view: View,
    visible: Visible,
    shape: tuple[int, int],
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
    layers: int,
    seen: FloatArray,
    surfaces: IntArray,
    whose: IntArray,
) -> None:
    """Put things before the background where some carry others.

    A carrier is open towards what it carries, but hides its underside. Seen is the farthest thing that nothing else
    hides. Of the things that carry nothing only the nearest counts: it hides the others.
    """
    owners, rows, boxes, hulls = parts.owners, visible.rows, solids.boxes, solids.hulls
    eye, a, b, c = view.position[2], view.rotation[2, 0], view.rotation[2, 1], view.rotation[2, 2]
    for i in range(shape[0]):
        for j in range(shape[1]):
            nearest = COMMON_LAYER
            for layer in range(COMMON_LAYER + 1, layers):
                if depths[layer, i, j] < depths[nearest, i, j]:
                    nearest = layer
            if depths[nearest, i, j] == math.inf:
                continue
            x, y = xs[i, j], ys[i, j]
            best = nearest
            if nearest != COMMON_LAYER:
                steep = a * x + b * y + c
                for layer in range(COMMON_LAYER, layers):
                    t = depths[layer, i, j]
                    if t == math.inf or t <= depths[best, i, j]:
                        continue
                    thing = owners[int(rows[numbers[layer, i, j], PLACE])]
                    height = eye + t * steep - boxes[thing, CZ] + boxes[thing, HZ]
                    hidden = steep > 0.0 and height < 2.0 * _UNDERSIDE * boxes[thing, HZ]
                    for other in range(COMMON_LAYER, layers):
                        if depths[other, i, j] < t:
                            before, is_open = owners[int(rows[numbers[other, i, j], PLACE])], False
                            for k in range(hulls.shape[1]):
                                is_open = is_open or hulls[thing, k] == before
                            hidden = hidden or not is_open
                    if not hidden:
                        best = layer
            floor = seen[i, j] if surfaces[i, j] == FLOOR else math.inf
            wall, length = depths[WALL_LAYER, i, j], math.sqrt(x * x + y * y + 1.0)
            for k in range(2):
                layer = nearest if k == 0 else best  # the latter, if the room does not hide it
                t = depths[layer, i, j]
                thing = owners[int(rows[numbers[layer, i, j], PLACE])]
                if t <= floor and t - boxes[thing, SLACK] / length <= wall:
                    seen[i, j], surfaces[i, j], whose[i, j] = t, thing, numbers[layer, i, j]
