"""Loops that draw parts and walls, over a window's pixels, which the compiler vectorises, or over single ones.

They keep the nearest depth of each pixel in ``depths`` and whose it is in ``numbers``, both (rows, cols) of the window.
``xs`` and ``ys`` are the rays' x and y at optical depth 1, of the same shape.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.render_entry import ball_entry, cube_entry, cylinder_entry, round_entry, wall_entry
from sim.render_parts import BALL, CUBE, HIGH_RADIUS, HOLE, KIND, LOW_RADIUS, MATRIX, ORIGIN, PLANE, RECT
from sim.render_rays import IntArray
from sim.visibility import View
from zavis_bt.types import FloatArray

_TIE = (
    1.0 + 1e-9
)  # of surfaces in the same place the one that is drawn last is seen: details come after what they are on
_JOINT = 1e-9  # [m] by which faces of walls overlap at their ends

_kernel = njit(cache=True, nogil=True, error_model="numpy")

Window = tuple[int, int, int, int]


@_kernel
def draw_part(
    row: FloatArray,
    form: FloatArray,
    number: int,
    window: Window,
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
) -> None:
    """Draw a part."""
    first_col, first_row, end_col, end_row = _clip(row[RECT : RECT + 4], window)
    kind, first, end = int(form[KIND]), first_col - window[0], end_col - window[0]
    for i in range(first_row - window[1], end_row - window[1]):
        x, y, line, owners = xs[i, first:end], ys[i, 0], depths[i, first:end], numbers[i, first:end]
        if kind == CUBE:
            _cube_line(row, y, x, line, owners, number)
        elif kind == BALL:
            _ball_line(row, y, x, line, owners, number)
        elif form[LOW_RADIUS] == form[HIGH_RADIUS] and form[HOLE] == 0.0:
            _cylinder_line(row, y, x, line, owners, number)
        else:
            _round_line(row, form, y, x, line, owners, number)


@_kernel
def draw_wall(
    wall: FloatArray,
    height: float,
    number: int,
    view: View,
    window: Window,
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
) -> None:
    """Draw a face of a wall."""
    first_col, first_row, end_col, end_row = _clip(wall[:4], window)
    r, (away, low, high, top) = view.rotation, face_from(wall, height, view)
    axis, first, end = int(wall[PLANE]) // 2, first_col - window[0], end_col - window[0]
    a0, b0, c0 = r[axis, 0], r[1 - axis, 0], r[2, 0]
    for i in range(first_row - window[1], end_row - window[1]):
        x, y, line, owners = xs[i, first:end], ys[i, 0], depths[i, first:end], numbers[i, first:end]
        a = r[axis, 1] * y + r[axis, 2]
        b = r[1 - axis, 1] * y + r[1 - axis, 2]
        c = r[2, 1] * y + r[2, 2]
        for k in range(len(x)):
            entry = wall_entry(a0 * x[k] + a, b0 * x[k] + b, c0 * x[k] + c, away, low, high, top)
            hit = entry < line[k] * _TIE
            line[k] = entry if hit else line[k]
            owners[k] = number if hit else owners[k]


@_kernel
def face_from(wall: FloatArray, height: float, view: View) -> tuple[float, float, float, float]:
    """Return a wall's face as seen from the eye: distance of its plane, begin, end and top [m]."""
    p, axis = view.position, int(wall[PLANE]) // 2
    across = p[1 - axis]
    return (
        wall[PLANE + 1] - p[axis],
        wall[PLANE + 2] - _JOINT - across,
        wall[PLANE + 3] + _JOINT - across,
        height - p[2],
    )


@_kernel
def points_on_part(
    rows: FloatArray,
    row: int,
    forms: FloatArray,
    part: int,
    pixels: NDArray[np.int64],
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
    layer: int,
) -> None:
    """Do what `draw_part` does, for single pixels (n, 2) whose rays, depths and numbers are (n, 1)."""
    ox, oy, oz = rows[row, ORIGIN], rows[row, ORIGIN + 1], rows[row, ORIGIN + 2]
    kind, low, high, hole = int(forms[part, KIND]), forms[part, LOW_RADIUS], forms[part, HIGH_RADIUS], forms[part, HOLE]
    for k in range(len(pixels)):
        u, v, x, y = pixels[k, 0], pixels[k, 1], xs[k, 0], ys[k, 0]
        if not (rows[row, RECT] <= u < rows[row, RECT + 2] and rows[row, RECT + 1] <= v < rows[row, RECT + 3]):
            continue
        dx = rows[row, MATRIX] * x + (rows[row, MATRIX + 1] * y + rows[row, MATRIX + 2])
        dy = rows[row, MATRIX + 3] * x + (rows[row, MATRIX + 4] * y + rows[row, MATRIX + 5])
        dz = rows[row, MATRIX + 6] * x + (rows[row, MATRIX + 7] * y + rows[row, MATRIX + 8])
        if kind == CUBE:
            t = cube_entry(ox, oy, oz, dx, dy, dz)
        elif kind == BALL:
            t = ball_entry(ox, oy, oz, dx, dy, dz)
        elif low == high and hole == 0.0:
            t = cylinder_entry(ox, oy, oz, dx, dy, dz)
        else:
            t = round_entry(ox, oy, oz, dx, dy, dz, low, high, hole)
        if t < depths[layer, k, 0] * _TIE:
            depths[layer, k, 0], numbers[layer, k, 0] = t, row


@_kernel
def points_on_wall(
    walls: FloatArray,
    number: int,
    height: float,
    view: View,
    pixels: NDArray[np.int64],
    xs: FloatArray,
    ys: FloatArray,
    depths: FloatArray,
    numbers: IntArray,
    layer: int,
) -> None:
    """Do what `draw_wall` does, for single pixels as in `points_on_part`."""
    r, (away, low, high, top) = view.rotation, face_from(walls[number], height, view)
    axis = int(walls[number, PLANE]) // 2
    for k in range(len(pixels)):
        u, v, x, y = pixels[k, 0], pixels[k, 1], xs[k, 0], ys[k, 0]
        if not (walls[number, 0] <= u < walls[number, 2] and walls[number, 1] <= v < walls[number, 3]):
            continue
        ahead = r[axis, 0] * x + (r[axis, 1] * y + r[axis, 2])
        along = r[1 - axis, 0] * x + (r[1 - axis, 1] * y + r[1 - axis, 2])
        t = wall_entry(ahead, along, r[2, 0] * x + (r[2, 1] * y + r[2, 2]), away, low, high, top)
        if t < depths[layer, k, 0] * _TIE:
            depths[layer, k, 0], numbers[layer, k, 0] = t, number


@_kernel
def _clip(rect: FloatArray, window: Window) -> Window:
    """Return the pixels of a rectangle that are in a window; empty if its end is not after its begin."""
    return (
        max(int(rect[0]), window[0]),
        max(int(rect[1]), window[1]),
        min(int(rect[2]), window[2]),
        min(int(rect[3]), window[3]),
    )


@_kernel
def _cube_line(row: FloatArray, y: float, xs: FloatArray, line: FloatArray, owners: IntArray, number: int) -> None:
    ox, oy, oz = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    ax, bx = row[MATRIX], row[MATRIX + 1] * y + row[MATRIX + 2]
    ay, by = row[MATRIX + 3], row[MATRIX + 4] * y + row[MATRIX + 5]
    az, bz = row[MATRIX + 6], row[MATRIX + 7] * y + row[MATRIX + 8]
    for k in range(len(xs)):
        entry = cube_entry(ox, oy, oz, ax * xs[k] + bx, ay * xs[k] + by, az * xs[k] + bz)
        hit = entry < line[k] * _TIE
        line[k] = entry if hit else line[k]
        owners[k] = number if hit else owners[k]


@_kernel
def _ball_line(row: FloatArray, y: float, xs: FloatArray, line: FloatArray, owners: IntArray, number: int) -> None:
    ox, oy, oz = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    ax, bx = row[MATRIX], row[MATRIX + 1] * y + row[MATRIX + 2]
    ay, by = row[MATRIX + 3], row[MATRIX + 4] * y + row[MATRIX + 5]
    az, bz = row[MATRIX + 6], row[MATRIX + 7] * y + row[MATRIX + 8]
    for k in range(len(xs)):
        entry = ball_entry(ox, oy, oz, ax * xs[k] + bx, ay * xs[k] + by, az * xs[k] + bz)
        hit = entry < line[k] * _TIE
        line[k] = entry if hit else line[k]
        owners[k] = number if hit else owners[k]


@_kernel
def _cylinder_line(row: FloatArray, y: float, xs: FloatArray, line: FloatArray, owners: IntArray, number: int) -> None:
    ox, oy, oz = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    ax, bx = row[MATRIX], row[MATRIX + 1] * y + row[MATRIX + 2]
    ay, by = row[MATRIX + 3], row[MATRIX + 4] * y + row[MATRIX + 5]
    az, bz = row[MATRIX + 6], row[MATRIX + 7] * y + row[MATRIX + 8]
    for k in range(len(xs)):
        entry = cylinder_entry(ox, oy, oz, ax * xs[k] + bx, ay * xs[k] + by, az * xs[k] + bz)
        hit = entry < line[k] * _TIE
        line[k] = entry if hit else line[k]
        owners[k] = number if hit else owners[k]


@_kernel
def _round_line(
    row: FloatArray, form: FloatArray, y: float, xs: FloatArray, line: FloatArray, owners: IntArray, number: int
) -> None:
    ox, oy, oz = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    ax, bx = row[MATRIX], row[MATRIX + 1] * y + row[MATRIX + 2]
    ay, by = row[MATRIX + 3], row[MATRIX + 4] * y + row[MATRIX + 5]
    az, bz = row[MATRIX + 6], row[MATRIX + 7] * y + row[MATRIX + 8]
    low, high, hole = form[LOW_RADIUS], form[HIGH_RADIUS], form[HOLE]
    for k in range(len(xs)):
        entry = round_entry(ox, oy, oz, ax * xs[k] + bx, ay * xs[k] + by, az * xs[k] + bz, low, high, hole)
        if entry < line[k] * _TIE:
            line[k], owners[k] = entry, number
