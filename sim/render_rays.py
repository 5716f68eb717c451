"""What hides what: the rules of visibility, and rays against boxes and walls by which simulated perception judges.

Rays are given as an origin and a direction of any length; distances ``t`` are in units of that length, so a unit
direction gives metres. The camera's images (`sim.render`) keep the same rules, but see the parts of things
(`sim.appearance`) where this module has their boxes: one sees between the legs of a chair there, and not here.

Visibility rules:
    * A box hides what lies behind it, whatever the box is.
    * A *hull* is open towards what it carries: the furniture an object stands on, and any box that holds the object's
      centre (shelves, open compartments, the space below a table top). Its top is not: the underside of an object
      that stands on it is hidden.
    * An object that touches a wall cell is not hidden by wall within the last `WALL_SLACK` before it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.types import FloatArray

NOTHING, FLOOR, WALL = -1, -2, -3
"""Surface ids beside the boxes' indices: no surface at all, the floor, a wall."""
WALL_SLACK = 0.12
"""Wall this close before an object that touches it does not hide the object [m]."""
TOP, BOTTOM = 5, 4
"""Faces of a box are numbered −x, +x, −y, +y, −z, +z in its own frame; a wall's likewise."""

_TINY = 1e-12  # stands for a direction component of zero, so that divisions stay finite
_TOUCHING = 1e-6  # relative distance below which two surfaces coincide

# Called once a ray: inlined, or counting references to their arrays would take longer than the work.
_kernel = njit(cache=True, error_model="numpy", inline="always")

IntArray = NDArray[np.int32]
Ray = tuple[float, float, float, float, float, float]
"""Origin and direction, map frame."""


# Columns of `Solids.boxes`.
CX, CY, CZ, HX, HY, HZ, COS, SIN, SLACK, CARRIES = range(10)


class Solids(NamedTuple):
    """Everything a ray can hit. Inner kernels take the arrays one by one: so numba need not count references."""

    boxes: FloatArray
    """(n, 10), furniture first, then objects: centre, half extents along the box's own axes, cosine and sine of the
    yaw, length of wall before it that does not hide it [m], and whether it is a hull of another box."""
    hulls: IntArray
    """(n, h) indices of the boxes that are open towards box i, padded with -1."""
    clearance: IntArray
    """(rows, cols) distance of a cell to the nearest wall cell, in chessboard moves."""
    room: FloatArray
    """(4,) outer corner x, y of cell [0, 0], side of a cell, height of the walls [m]."""


@_kernel
def box_entry(boxes: FloatArray, box: int, ray: Ray) -> tuple[float, int]:
    """Return where a ray enters a box and through which face; (inf, -1) if it misses or starts inside."""
    cos, sin = boxes[box, COS], boxes[box, SIN]
    x, y = ray[0] - boxes[box, CX], ray[1] - boxes[box, CY]
    entry, leave, face = -math.inf, math.inf, -1
    for axis in range(3):
        if axis == 0:
            start, step = cos * x + sin * y, cos * ray[3] + sin * ray[4]
        elif axis == 1:
            start, step = cos * y - sin * x, cos * ray[4] - sin * ray[3]
        else:
            start, step = ray[2] - boxes[box, CZ], ray[5]
        half = boxes[box, HX + axis]
        inverse = 1.0 / (step if abs(step) > _TINY else _TINY)
        near, far, side = (-half - start) * inverse, (half - start) * inverse, 2 * axis
        if near > far:
            near, far, side = far, near, side + 1
        if near > entry:
            entry, face = near, side
        leave = min(leave, far)
    if entry > leave or entry <= 0.0:
        return math.inf, -1
    return entry, face


@_kernel
def wall_entry(clearance: IntArray, room: FloatArray, ray: Ray, limit: float) -> tuple[float, int]:
    """Return where a ray first meets a wall before ``limit``, and the face; (inf, -1) if it does not.

    Walks the grid exactly, leaping over squares of cells that hold no wall. A ray that starts within a wall leaves it
    unhindered.
    """
    rows, cols = clearance.shape
    scale = 1.0 / room[2]
    x, y = (ray[0] - room[0]) * scale, (ray[1] - room[1]) * scale  # [cells]
    ux = ray[3] * scale if abs(ray[3]) > _TINY else _TINY
    uy = ray[4] * scale if abs(ray[4]) > _TINY else _TINY
    inverse_x, inverse_y = 1.0 / ux, 1.0 / uy
    col, row = math.floor(x), math.floor(y)
    t, face, outside = 0.0, -1, False
    while 0 <= row < rows and 0 <= col < cols and t < limit:
        free = clearance[row, col]
        reach = max(free, 1)
        tx = ((col + reach if ux > 0 else col - reach + 1) - x) * inverse_x
        ty = ((row + reach if uy > 0 else row - reach + 1) - y) * inverse_y
        leave = min(tx, ty)
        if free > 0:
            outside = True
        elif outside:
            z = ray[2] + t * ray[5]
            if z <= room[3]:
                return t, face
            if ray[5] >= 0.0:
                return math.inf, -1
            top = (room[3] - ray[2]) / ray[5]
            if top < leave:
                return (top, TOP) if top < limit else (math.inf, -1)
        t = leave
        if tx < ty:
            face = 0 if ux > 0 else 1
            col = col + reach if ux > 0 else col - reach
            row = min(max(math.floor(y + t * uy), row - reach + 1), row + reach - 1)
        else:
            face = 2 if uy > 0 else 3
            row = row + reach if uy > 0 else row - reach
            col = min(max(math.floor(x + t * ux), col - reach + 1), col + reach - 1)
    return math.inf, -1


@njit(cache=True, nogil=True, error_model="numpy")
def is_hull(hulls: IntArray, box: int, other: int) -> bool:
    """Return whether ``other`` is open towards ``box``."""
    for k in range(hulls.shape[1]):
        if hulls[box, k] == other:
            return True
        if hulls[box, k] < 0:
            break
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def is_hidden(
    boxes: FloatArray,
    hulls: IntArray,
    clearance: IntArray,
    room: FloatArray,
    ray: Ray,
    box: int,
    others: IntArray,
    count: int,
) -> bool:
    """Return whether the point at distance 1 on the ray, on the surface of ``box``, is hidden from its origin.

    Args:
        boxes: As in `Solids`.
        hulls: As in `Solids`.
        clearance: As in `Solids`.
        room: As in `Solids`.
        ray: From the eye to the point.
        box: Whose surface it is.
        others: Its first ``count`` entries are the boxes that may hide it.
        count: How many.
    """
    for k in range(count):
        entry, _ = box_entry(boxes, others[k], ray)
        if entry < 1.0 - _TOUCHING and not is_hull(hulls, box, others[k]):
            return True
    wall, _ = wall_entry(clearance, room, ray, 1.0 - _TOUCHING)
    length = math.sqrt(ray[3] * ray[3] + ray[4] * ray[4] + ray[5] * ray[5])
    slack: float = boxes[box, SLACK]
    return wall < 1.0 - slack / length
