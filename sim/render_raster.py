"""Where the rays of a window's pixels enter parts and walls: loops without branches, which the compiler vectorises.

All functions keep the nearest depth of each pixel in ``depths`` and whose it is in ``numbers``, both (rows, cols) of the
window that begins at ``left`` and ``top``. ``xs`` and ``ys`` are the rays' x and y at optical depth 1 for each column and
row of the image.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim.render_parts import BALL, CUBE, HIGH_RADIUS, HOLE, KIND, LOW_RADIUS, MATRIX, ORIGIN, PLANE, RECT
from sim.render_rays import IntArray
from sim.visibility import View
from zavis_bt.types import FloatArray

_TINY = 1e-12  # stands for a direction component of zero, so that divisions stay finite
_JOINT = 1e-9  # [m] by which faces of walls overlap at their ends

_kernel = njit(cache=True, nogil=True, error_model="numpy")

Window = tuple[int, int, int, int]


@_kernel
def clip(rect: FloatArray, window: Window) -> Window:
    """Return the pixels of a rectangle that are in a window; empty if its end is not after its begin."""
    return (
        max(int(rect[0]), window[0]),
        max(int(rect[1]), window[1]),
        min(int(rect[2]), window[2]),
        min(int(rect[3]), window[3]),
    )


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
    """Draw a part; a ray that starts within it does not hit it."""
    box = clip(row[RECT : RECT + 4], window)
    if box[0] >= box[2] or box[1] >= box[3]:
        return
    kind = int(form[KIND])
    for v in range(box[1], box[3]):
        line, owners = depths[v - window[1], box[0] - window[0] :], numbers[v - window[1], box[0] - window[0] :]
        x = xs[box[0] : box[2]]
        if kind == CUBE:
            _cube_line(row, ys[v], x, line, owners, number)
        elif kind == BALL:
            _ball_line(row, ys[v], x, line, owners, number)
        elif form[LOW_RADIUS] == form[HIGH_RADIUS] and form[HOLE] == 0.0:
            _cylinder_line(row, ys[v], x, line, owners, number)
        else:
            _round_line(row, form, ys[v], x, line, owners, number)


@_kernel
def _cube_line(row: FloatArray, y: float, xs: FloatArray, line: FloatArray, owners: IntArray, number: int) -> None:
    ox, oy, oz = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    ax, bx = row[MATRIX], row[MATRIX + 1] * y + row[MATRIX + 2]
    ay, by = row[MATRIX + 3], row[MATRIX + 4] * y + row[MATRIX + 5]
    az, bz = row[MATRIX + 6], row[MATRIX + 7] * y + row[MATRIX + 8]
    for k in range(len(xs)):
        dx, dy, dz = ax * xs[k] + bx, ay * xs[k] + by, az * xs[k] + bz
        ix = 1.0 / (dx if abs(dx) > _TINY else _TINY)
        iy = 1.0 / (dy if abs(dy) > _TINY else _TINY)
        iz = 1.0 / (dz if abs(dz) > _TINY else _TINY)
        mx, my, mz = -ox * ix, -oy * iy, -oz * iz  # where the ray passes the middle planes
        hx, hy, hz = abs(ix), abs(iy), abs(iz)
        entry = max(max(mx - hx, my - hy), mz - hz)
        leave = min(min(mx + hx, my + hy), mz + hz)
        hit = (entry <= leave) & (entry > 0.0) & (entry < line[k])
        line[k] = entry if hit else line[k]
        owners[k] = number if hit else owners[k]


@_kernel
def _ball_line(row: FloatArray, y: float, xs: FloatArray, line: FloatArray, owners: IntArray, number: int) -> None:
    ox, oy, oz = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    ax, bx = row[MATRIX], row[MATRIX + 1] * y + row[MATRIX + 2]
    ay, by = row[MATRIX + 3], row[MATRIX + 4] * y + row[MATRIX + 5]
    az, bz = row[MATRIX + 6], row[MATRIX + 7] * y + row[MATRIX + 8]
    outside = ox * ox + oy * oy + oz * oz - 1.0
    for k in range(len(xs)):
        dx, dy, dz = ax * xs[k] + bx, ay * xs[k] + by, az * xs[k] + bz
        a, b = dx * dx + dy * dy + dz * dz, ox * dx + oy * dy + oz * dz
        inside = b * b - a * outside
        entry = (-b - math.sqrt(max(inside, 0.0))) / a
        hit = (inside >= 0.0) & (entry > 0.0) & (entry < line[k])
        line[k] = entry if hit else line[k]
        owners[k] = number if hit else owners[k]


@_kernel
def _cylinder_line(row: FloatArray, y: float, xs: FloatArray, line: FloatArray, owners: IntArray, number: int) -> None:
    ox, oy, oz = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    ax, bx = row[MATRIX], row[MATRIX + 1] * y + row[MATRIX + 2]
    ay, by = row[MATRIX + 3], row[MATRIX + 4] * y + row[MATRIX + 5]
    az, bz = row[MATRIX + 6], row[MATRIX + 7] * y + row[MATRIX + 8]
    outside = ox * ox + oy * oy - 1.0
    for k in range(len(xs)):
        dx, dy, dz = ax * xs[k] + bx, ay * xs[k] + by, az * xs[k] + bz
        iz = 1.0 / (dz if abs(dz) > _TINY else _TINY)
        mz, hz = -oz * iz, abs(iz)
        a, b = max(dx * dx + dy * dy, _TINY * _TINY), ox * dx + oy * dy
        inside = b * b - a * outside
        reach = math.sqrt(max(inside, 0.0))
        entry = max((-b - reach) / a, mz - hz)
        leave = min((-b + reach) / a, mz + hz)
        hit = (inside >= 0.0) & (entry <= leave) & (entry > 0.0) & (entry < line[k])
        line[k] = entry if hit else line[k]
        owners[k] = number if hit else owners[k]


@_kernel
def _round_line(
    row: FloatArray, form: FloatArray, y: float, xs: FloatArray, line: FloatArray, owners: IntArray, number: int
) -> None:
    """Draw a body of changing radius, or with a hole: the nearest of its outer side, inner side and ends."""
    ox, oy, oz = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    ax, bx = row[MATRIX], row[MATRIX + 1] * y + row[MATRIX + 2]
    ay, by = row[MATRIX + 3], row[MATRIX + 4] * y + row[MATRIX + 5]
    az, bz = row[MATRIX + 6], row[MATRIX + 7] * y + row[MATRIX + 8]
    middle, slope = (form[LOW_RADIUS] + form[HIGH_RADIUS]) / 2, (form[HIGH_RADIUS] - form[LOW_RADIUS]) / 2
    hole = form[HOLE]
    for k in range(len(xs)):
        dx, dy, dz = ax * xs[k] + bx, ay * xs[k] + by, az * xs[k] + bz
        dz = dz if abs(dz) > _TINY else _TINY
        entry = _end_entry(ox, oy, oz, dx, dy, dz, form[LOW_RADIUS], form[HIGH_RADIUS], hole)
        entry = min(entry, _side_entry(ox, oy, oz, dx, dy, dz, middle, slope))
        if hole > 0.0:
            entry = min(entry, _side_entry(ox, oy, oz, dx, dy, dz, middle * hole, slope * hole))
        if entry < line[k]:
            line[k], owners[k] = entry, number


@_kernel
def _end_entry(
    ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, low: float, high: float, hole: float
) -> float:
    """Return where a ray first meets one of the two flat ends, inf if it meets none."""
    entry = math.inf
    for end in (-1.0, 1.0):
        t = (end - oz) / dz
        x, y, radius = ox + t * dx, oy + t * dy, low if end < 0.0 else high
        square = x * x + y * y
        if t > 0.0 and square <= radius * radius and square >= radius * radius * hole * hole:
            entry = min(entry, t)
    return entry


@_kernel
def _side_entry(
    ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, middle: float, slope: float
) -> float:
    """Return where a ray first meets the side of radius ``middle + slope z`` for z from -1 to 1, inf if it does not."""
    radius, change = middle + slope * oz, slope * dz
    a, b = dx * dx + dy * dy - change * change, ox * dx + oy * dy - radius * change
    c = ox * ox + oy * oy - radius * radius
    inside = b * b - a * c
    if inside < 0.0:
        return math.inf
    a = a if abs(a) > _TINY * _TINY else _TINY * _TINY
    reach, entry = math.sqrt(inside), math.inf
    for t in ((-b - reach) / a, (-b + reach) / a):
        if t > 0.0 and abs(oz + t * dz) <= 1.0:
            entry = min(entry, t)
    return entry


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
    box = clip(wall[:4], window)
    if box[0] >= box[2] or box[1] >= box[3]:
        return
    r, p = view.rotation, view.position
    axis = int(wall[PLANE]) // 2
    away, across = wall[PLANE + 1] - p[axis], p[1 - axis]
    low, high, top = wall[PLANE + 2] - _JOINT - across, wall[PLANE + 3] + _JOINT - across, height - p[2]
    a0, a1, a2 = r[axis, 0], r[axis, 1], r[axis, 2]
    b0, b1, b2 = r[1 - axis, 0], r[1 - axis, 1], r[1 - axis, 2]
    for v in range(box[1], box[3]):
        line, owners = depths[v - window[1], box[0] - window[0] :], numbers[v - window[1], box[0] - window[0] :]
        y, x = ys[v], xs[box[0] : box[2]]
        a, b, c = a1 * y + a2, b1 * y + b2, r[2, 1] * y + r[2, 2]
        for k in range(len(x)):
            ahead = a0 * x[k] + a
            t = away / (ahead if abs(ahead) > _TINY else _TINY)
            along, up = t * (b0 * x[k] + b), t * (r[2, 0] * x[k] + c)
            hit = (t > 0.0) & (along >= low) & (along <= high) & (up <= top) & (t < line[k])
            line[k] = t if hit else line[k]
            owners[k] = number if hit else owners[k]


@_kernel
def rays_of(view: View) -> tuple[FloatArray, FloatArray]:
    """Return (width,) x and (height,) y of the rays through the pixels' centres at optical depth 1."""
    xs, ys = np.empty(view.width), np.empty(view.height)
    for col in range(view.width):
        xs[col] = (col + 0.5 - view.cx) / view.fx
    for row in range(view.height):
        ys[row] = (row + 0.5 - view.cy) / view.fy
    return xs, ys
