"""What an image shows of each thing, pixel by pixel: labels for training and for judging networks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.render_parts import PLACE, RECT, Parts, Visible
from sim.render_raster import draw_part
from sim.render_rays import IntArray
from sim.visibility import View
from zavis_bt.types import Box, FloatArray

_kernel = njit(cache=True, nogil=True, error_model="numpy")


class Label(NamedTuple):
    """One thing that an image shows."""

    number: int
    """In `Scene.things` and in `SimFrame.surfaces`."""
    id: str
    category: str
    colour: str | None
    """Basic name of the body's colour as it is painted."""
    is_furniture: bool
    box: Box
    """The smallest that holds all its pixels [px]."""
    pixels: int
    """How many it has in the image."""
    visible_fraction: float
    """Share of the pixels that it would have if nothing were before it; what is outside the image does not count."""


def pixel_boxes(surfaces: IntArray, count: int) -> tuple[IntArray, NDArray[np.int64]]:
    """Return the tight boxes of things in an image.

    Args:
        surfaces: (h, w) index of the thing of each pixel; negative ones are no things.
        count: How many things there are.

    Returns:
        (count, 4) first column and row, end column and row, all 0 where there is no pixel; (count,) pixels.
    """
    boxes, pixels = np.zeros((count, 4), dtype=np.int32), np.zeros(count, dtype=np.int64)
    _bound(surfaces, boxes, pixels)
    return boxes, pixels


def whole_pixels(parts: Parts, visible: Visible, view: View) -> NDArray[np.int64]:
    """Return (n,) how many pixels of the image each thing would have if nothing were before it."""
    pixels = np.zeros(len(parts.spheres), dtype=np.int64)
    _count_alone(parts, visible, view, pixels)
    return pixels


@_kernel
def _bound(surfaces: IntArray, boxes: IntArray, pixels: NDArray[np.int64]) -> None:
    for row in range(surfaces.shape[0]):
        for col in range(surfaces.shape[1]):
            thing = surfaces[row, col]
            if thing < 0:
                continue
            if pixels[thing] == 0:
                boxes[thing, 0], boxes[thing, 1], boxes[thing, 2] = col, row, col + 1
            pixels[thing] += 1
            boxes[thing, 0], boxes[thing, 2] = min(boxes[thing, 0], col), max(boxes[thing, 2], col + 1)
            boxes[thing, 3] = row + 1


@_kernel
def _count_alone(parts: Parts, visible: Visible, view: View, pixels: NDArray[np.int64]) -> None:
    for k in range(len(visible.things)):
        thing, begin, end, left, top, right, bottom = visible.things[k]
        height, width = bottom - top, right - left
        depths: FloatArray = np.full((height, width), np.inf)
        numbers, xs, ys = np.empty((height, width), np.int32), np.empty((height, width)), np.empty((height, width))
        for i in range(height):
            for j in range(width):
                xs[i, j], ys[i, j] = (left + j + 0.5 - view.cx) / view.fx, (top + i + 0.5 - view.cy) / view.fy
        window = (int(left), int(top), int(right), int(bottom))
        for row in range(begin, end):
            if visible.rows[row, RECT] < right:
                form = parts.forms[int(visible.rows[row, PLACE])]
                draw_part(visible.rows[row], form, row, window, xs, ys, depths, numbers)
        count = 0
        for i in range(height):
            for j in range(width):
                count += 1 if depths[i, j] < np.inf else 0
        pixels[thing] = count
