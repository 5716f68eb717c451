"""What a pixel sees where carriers and what they carry overlap."""

from __future__ import annotations

import math

from numba import njit

from sim.render_parts import BALL, CUBE, HIGH_RADIUS, KIND, LOW_RADIUS, MATRIX, ORIGIN, PLACE, Parts, Visible
from sim.render_rays import IntArray, Solids, is_hull
from zavis_bt.types import FloatArray

_UNDERSIDE = -0.7  # z of the unit normals of undersides, at most

_kernel = njit(cache=True, nogil=True, error_model="numpy")


@_kernel
def choose(
    solids: Solids,
    parts: Parts,
    visible: Visible,
    depths: FloatArray,
    numbers: IntArray,
    layers: int,
    i: int,
    j: int,
    x: float,
    y: float,
) -> tuple[int, int]:
    """Return the layers of what a pixel sees, and of what is nearest; layer 0 (the walls) is not looked at.

    A carrier is open towards what it carries, but hides its underside. Seen is the farthest thing that nothing else
    hides. Of the things that carry nothing only the nearest counts: it hides the others.
    """
    nearest = 1
    for layer in range(2, layers):
        if depths[layer, i, j] < depths[nearest, i, j]:
            nearest = layer
    if depths[nearest, i, j] == math.inf or nearest == 1:
        return nearest, nearest
    seen = nearest
    for layer in range(1, layers):
        t = depths[layer, i, j]
        if t == math.inf or t <= depths[seen, i, j]:
            continue
        thing, hidden = _owner(parts, visible, numbers[layer, i, j]), False
        for other in range(1, layers):
            if depths[other, i, j] < t and not is_hull(
                solids.hulls, thing, _owner(parts, visible, numbers[other, i, j])
            ):
                hidden = True
                break
        if not hidden and not _is_underside(parts, visible, numbers[layer, i, j], x, y, t):
            seen = layer
    return seen, nearest


@_kernel
def _owner(parts: Parts, visible: Visible, number: int) -> int:
    return int(parts.owners[int(visible.rows[number, PLACE])])


@_kernel
def _is_underside(parts: Parts, visible: Visible, number: int, x: float, y: float, t: float) -> bool:
    """Return whether a ray hits a part where it faces down."""
    row = visible.rows[number]
    part = int(row[PLACE])
    form, inverse = parts.forms[part], parts.inverses[part]
    px = row[ORIGIN] + t * (row[MATRIX] * x + row[MATRIX + 1] * y + row[MATRIX + 2])
    py = row[ORIGIN + 1] + t * (row[MATRIX + 3] * x + row[MATRIX + 4] * y + row[MATRIX + 5])
    pz = row[ORIGIN + 2] + t * (row[MATRIX + 6] * x + row[MATRIX + 7] * y + row[MATRIX + 8])
    kind, gx, gy, gz = int(form[KIND]), px, py, pz
    if kind == CUBE:
        largest = max(max(abs(px), abs(py)), abs(pz))
        gx = px if abs(px) == largest else 0.0
        gy = py if abs(py) == largest else 0.0
        gz = pz if abs(pz) == largest else 0.0
    elif kind != BALL:
        slope = (form[HIGH_RADIUS] - form[LOW_RADIUS]) / 2
        radius = (form[LOW_RADIUS] + form[HIGH_RADIUS]) / 2 + slope * pz
        gz = -slope * radius
        if abs(pz) > 1.0 - 1e-7:
            gx, gy, gz = 0.0, 0.0, pz
    nx = inverse[0] * gx + inverse[3] * gy + inverse[6] * gz
    ny = inverse[1] * gx + inverse[4] * gy + inverse[7] * gz
    nz = inverse[2] * gx + inverse[5] * gy + inverse[8] * gz
    return bool(nz < _UNDERSIDE * math.sqrt(nx * nx + ny * ny + nz * nz))
