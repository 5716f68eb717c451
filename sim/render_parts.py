"""What the camera sees of a scene: parts of things in the map, and what one view can show of them.

A *part* is a solid in its own space, where it fills the cube from -1 to 1: a cube, a ball, or a round body about its
third axis. Its *frame* takes that space to the map. A *ray* goes from the optical centre through a pixel and has
optical depth 1, so that distances along it are depths.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim.render_rays import IntArray
from sim.visibility import NEAR, View
from zavis_bt.types import FloatArray

CUBE, BALL, ROUND, TUBE = range(4)
"""Forms of parts: a cube, a ball, a solid round body, one with a round hole along its axis."""
KIND, LOW_RADIUS, HIGH_RADIUS, HOLE = range(4)
"""Columns of `Parts.forms`; the hole is a share of the radius."""
ORIGIN, MATRIX, RECT, PLACE, COLUMNS = 0, 3, 12, 16, 17
"""First columns in `Visible.rows`: eye and ray matrix in the part's space, rectangle [px], which part."""
PLANE, WALL_COLUMNS = 4, 8
"""First column after the rectangle in `Visible.walls`: face, coordinate, low and high end [m]."""

_kernel = njit(cache=True, nogil=True, error_model="numpy")


class Parts(NamedTuple):
    """The parts of n things, m in all; part rows ``first[i]`` to ``first[i + 1]`` belong to thing i."""

    first: IntArray
    """(n + 1,)"""
    owners: IntArray
    """(m,) which thing it is of."""
    frames: FloatArray
    """(m, 12) middle and the three half axes in the map [m]."""
    inverses: FloatArray
    """(m, 12) rows of the matrix from the map to the part's space, then the offset."""
    forms: FloatArray
    """(m, 4) see `KIND`."""
    paints: FloatArray
    """(m, PAINT) see `sim.render_shade`."""
    spheres: FloatArray
    """(n, 4) middle and radius of a ball around each thing [m]."""


class Visible(NamedTuple):
    """What one view may show; whatever is surely outside the image is left out."""

    things: IntArray
    """(k, 7) thing, first and end row of its parts, rectangle around them [px]: first column and row, end ones."""
    rows: FloatArray
    """(r, COLUMNS) parts, see `ORIGIN`."""
    walls: FloatArray
    """(w, WALL_COLUMNS) faces of walls turned to the camera, see `PLANE`."""


def visible_parts(parts: Parts, faces: FloatArray, wall_height: float, view: View) -> Visible:
    """Return what a view may show.

    Args:
        parts: Of the scene.
        faces: (w, 4) faces of walls, see `wall_faces`.
        wall_height: [m]
        view: The camera.
    """
    things = np.empty((len(parts.spheres), 7), dtype=np.int32)
    rows, walls = np.empty((len(parts.owners), COLUMNS)), np.empty((len(faces), WALL_COLUMNS))
    thing_count, row_count, wall_count = _collect(parts, faces, wall_height, view, things, rows, walls)
    return Visible(things[:thing_count], rows[:row_count], walls[:wall_count])


def wall_faces(walls: np.ndarray, resolution: float, origin: tuple[float, float]) -> FloatArray:
    """Return the vertical faces of walls, runs of cells' sides as long as can be.

    Args:
        walls: (rows, cols) which cells are wall.
        resolution: Side of a cell [m].
        origin: Outer corner of cell [0, 0] [m].

    Returns:
        (w, 4) each: side it lies on (0 to 3 for −x, +x, −y, +y of the wall), coordinate of its plane, low and high end
        along the other axis [m]. What borders on the outside of the map has no face.
    """
    found = []
    for axis, cells in enumerate((walls, walls.T)):
        steps = np.diff(cells.astype(np.int8), axis=1)
        for side, sign in enumerate((1, -1)):
            edges = np.pad(steps == sign, ((1, 1), (0, 0))).astype(np.int8)
            starts, ends = (np.argwhere(change == np.diff(edges, axis=0).T) for change in (1, -1))
            x0, y0 = origin[axis], origin[1 - axis]
            planes = x0 + (starts[:, 0] + 1) * resolution
            low, high = y0 + starts[:, 1] * resolution, y0 + ends[:, 1] * resolution
            found.append(np.column_stack((np.full(len(starts), 2.0 * axis + side), planes, low, high)))
    return np.ascontiguousarray(np.vstack(found), dtype=np.float64)


@_kernel
def _collect(
    parts: Parts,
    faces: FloatArray,
    wall_height: float,
    view: View,
    things: IntArray,
    rows: FloatArray,
    walls: FloatArray,
) -> tuple[int, int, int]:
    corners, frame, rect = np.empty((8, 3)), np.empty(12), np.empty(4)
    thing_count, count = 0, 0
    for thing in range(len(parts.spheres)):
        if _ball_is_outside(parts.spheres[thing], view):
            continue
        begin = count
        for part in range(parts.first[thing], parts.first[thing + 1]):
            if not _place(parts.frames[part], view, corners, rect):
                continue
            _enter(parts.inverses[part], view, rows[count])
            if not _holds_eye(parts.forms[part], rows[count]):
                rows[count, RECT : RECT + 4] = rect
                rows[count, PLACE] = part
                count += 1
        if count > begin:
            _note(things[thing_count], thing, begin, count, rows)
            thing_count += 1
    wall_count = 0
    for k in range(len(faces)):
        _face_frame(faces[k], wall_height, frame)
        axis, sign = int(faces[k, 0]) // 2, 1.0 if faces[k, 0] % 2 == 0 else -1.0
        if (faces[k, 1] - view.position[axis]) * sign > 0.0 and _place(frame, view, corners, rect):
            walls[wall_count, :PLANE] = rect
            walls[wall_count, PLANE:] = faces[k]
            wall_count += 1
    return thing_count, count, wall_count


@_kernel
def _note(entry: IntArray, thing: int, begin: int, end: int, rows: FloatArray) -> None:
    """Write down a thing whose parts are in the rows from begin to end."""
    entry[0], entry[1], entry[2] = thing, begin, end
    entry[3], entry[4], entry[5], entry[6] = 1 << 30, 1 << 30, 0, 0
    for row in range(begin, end):
        for k in range(2):
            entry[3 + k] = min(entry[3 + k], int(rows[row, RECT + k]))
            entry[5 + k] = max(entry[5 + k], int(rows[row, RECT + 2 + k]))


@_kernel
def _ball_is_outside(ball: FloatArray, view: View) -> bool:
    """Return whether a ball is surely outside the image."""
    x, y, z = _turn(view, ball[0] - view.position[0], ball[1] - view.position[1], ball[2] - view.position[2])
    right, bottom = view.width - view.cx, view.height - view.cy
    return bool(
        z < NEAR - ball[3]
        or x * view.fx + z * view.cx < -ball[3] * math.hypot(view.fx, view.cx)
        or z * right - x * view.fx < -ball[3] * math.hypot(view.fx, right)
        or y * view.fy + z * view.cy < -ball[3] * math.hypot(view.fy, view.cy)
        or z * bottom - y * view.fy < -ball[3] * math.hypot(view.fy, bottom)
    )


@_kernel
def _turn(view: View, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a direction in the map as the camera has it."""
    r = view.rotation
    return (
        x * r[0, 0] + y * r[1, 0] + z * r[2, 0],
        x * r[0, 1] + y * r[1, 1] + z * r[2, 1],
        x * r[0, 2] + y * r[1, 2] + z * r[2, 2],
    )


@_kernel
def _face_frame(face: FloatArray, height: float, frame: FloatArray) -> None:
    """Write a wall's face as a frame whose third axis has no length."""
    frame[:] = 0.0
    axis = int(face[0]) // 2
    frame[axis], frame[1 - axis], frame[2] = face[1], (face[2] + face[3]) / 2, height / 2
    frame[3 + 1 - axis] = (face[3] - face[2]) / 2
    frame[8] = height / 2


@_kernel
def _place(frame: FloatArray, view: View, corners: FloatArray, rect: FloatArray) -> bool:
    """Find the rectangle of pixels, first and end ones, that a frame's cube meets; returns whether there is one."""
    p = view.position
    cx, cy, cz = _turn(view, frame[0] - p[0], frame[1] - p[1], frame[2] - p[2])
    ax, ay, az = _turn(view, frame[3], frame[4], frame[5])
    bx, by, bz = _turn(view, frame[6], frame[7], frame[8])
    dx, dy, dz = _turn(view, frame[9], frame[10], frame[11])
    if cz + abs(az) + abs(bz) + abs(dz) <= NEAR:
        return False
    u0, v0, u1, v1, behind = math.inf, math.inf, -math.inf, -math.inf, False
    for k in range(8):
        a, b, c = 2.0 * (k & 1) - 1.0, 1.0 * (k & 2) - 1.0, 0.5 * (k & 4) - 1.0
        x, y, z = cx + a * ax + b * bx + c * dx, cy + a * ay + b * by + c * dy, cz + a * az + b * bz + c * dz
        corners[k, 0], corners[k, 1], corners[k, 2] = x, y, z
        if z <= NEAR:
            behind = True
            continue
        u, v = view.fx * x / z, view.fy * y / z
        u0, v0, u1, v1 = min(u0, u), min(v0, v), max(u1, u), max(v1, v)
    if behind:
        for k in range(8):
            for bit in (1, 2, 4):
                other = k ^ bit
                if corners[k, 2] > NEAR >= corners[other, 2]:
                    share = (NEAR - corners[k, 2]) / (corners[other, 2] - corners[k, 2])
                    u = view.fx * (corners[k, 0] + share * (corners[other, 0] - corners[k, 0])) / NEAR
                    v = view.fy * (corners[k, 1] + share * (corners[other, 1] - corners[k, 1])) / NEAR
                    u0, v0, u1, v1 = min(u0, u), min(v0, v), max(u1, u), max(v1, v)
    # A pixel's ray goes through its centre; half a pixel more allows for rounding.
    rect[0], rect[1] = max(math.floor(u0 + view.cx - 1.0), 0.0), max(math.floor(v0 + view.cy - 1.0), 0.0)
    rect[2] = min(math.ceil(u1 + view.cx + 1.0), float(view.width))
    rect[3] = min(math.ceil(v1 + view.cy + 1.0), float(view.height))
    return bool(rect[0] < rect[2] and rect[1] < rect[3])


@_kernel
def _enter(inverse: FloatArray, view: View, row: FloatArray) -> None:
    """Write the eye and the matrix from the camera's directions to a part's space."""
    p, r = view.position, view.rotation
    for i in range(3):
        a, b, c = inverse[3 * i], inverse[3 * i + 1], inverse[3 * i + 2]
        row[ORIGIN + i] = a * p[0] + b * p[1] + c * p[2] + inverse[9 + i]
        for j in range(3):
            row[MATRIX + 3 * i + j] = a * r[0, j] + b * r[1, j] + c * r[2, j]


@_kernel
def _holds_eye(form: FloatArray, row: FloatArray) -> bool:
    """Return whether the eye is within a solid part: such a part does not blind it."""
    x, y, z = row[ORIGIN], row[ORIGIN + 1], row[ORIGIN + 2]
    kind = int(form[KIND])
    if kind == CUBE:
        return bool(max(abs(x), abs(y), abs(z)) <= 1.0)
    if kind == BALL:
        return bool(x * x + y * y + z * z <= 1.0)
    radius = (form[LOW_RADIUS] + form[HIGH_RADIUS] + (form[HIGH_RADIUS] - form[LOW_RADIUS]) * z) / 2
    return bool(abs(z) <= 1.0 and x * x + y * y <= radius * radius)
