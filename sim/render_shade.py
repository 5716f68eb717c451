"""Colours of what rays hit: paint, pattern and light."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim.render_parts import BALL, CUBE, HIGH_RADIUS, HOLE, KIND, LOW_RADIUS, MATRIX, ORIGIN
from sim.render_texture import PLAIN, SPINES, noise, pattern
from zavis_bt.types import FloatArray

INK, TEXTURE, REPEAT_U, REPEAT_V, SEED, FACES, GLOSS, DENSITY, EDGES, LIGHTS, PAINT = 3, 6, 7, 8, 9, 10, 11, 12, 13, 16, 22
"""Columns of `Parts.paints` after the colour: second colour, pattern, its repeats over a face, its seed, bits of the
faces that have it, gloss 0 to 1, cells of the pattern per metre, widths of the dark edges along the three axes, light
on the six faces (−x, +x, −y, +y, −z, +z in the part's space)."""
LAMP, AMBIENT, DIFFUSE, TINT, WALL_LOOK, FLOOR_LOOK, SKIRTING, SKY, ROOM = 0, 3, 4, 5, 8, 18, 28, 32, 35
"""First columns of a room's look: direction to the lamp, light everywhere, light of the lamp, its colour; for walls and
floor the columns of a paint from colour to seed, with repeats per metre; the skirting's colour and height [m]; the
colour of what is above the walls."""

_EDGE_SHADE = 0.72
_BOOKS = np.array(
    [(158, 44, 42), (38, 66, 128), (52, 104, 66), (206, 178, 118), (92, 58, 44), (222, 214, 196), (60, 60, 66), (196, 118, 46)],
    dtype=np.float64,
)  # fmt: skip
_MEAN = 0.4  # what patterns fade to

_kernel = njit(cache=True, nogil=True, error_model="numpy")

Colour = tuple[float, float, float]


@_kernel
def light_on(room: FloatArray, nx: float, ny: float, nz: float) -> float:
    """Return the light on a surface with this unit normal: half-Lambert, dim where turned away but not black."""
    facing = 0.5 + 0.5 * (nx * room[LAMP] + ny * room[LAMP + 1] + nz * room[LAMP + 2])
    return float(room[AMBIENT] + room[DIFFUSE] * facing)


@_kernel
def mix(paint: FloatArray, first: int, u: float, v: float, width: float) -> Colour:
    """Return the unlit colour at a point of a face.

    Args:
        paint: Colours and pattern.
        first: Column its first colour begins at; texture and repeats follow the second.
        u: Along the face.
        v: Along the face.
        width: Cells of the pattern per pixel.
    """
    share, fade = 0.0, min(max(2.0 - 2.2 * width, 0.0), 1.0)
    texture = int(paint[first + TEXTURE])
    if fade > 0.0:
        share = pattern(texture, u, v, paint[first + REPEAT_U], paint[first + REPEAT_V], int(paint[first + SEED]))
    if share < 0.0:  # a book's back
        cell = math.floor(u * paint[first + REPEAT_U])
        book = int(noise(cell, 9, int(paint[first + SEED])) * 7.999)
        return _BOOKS[book, 0], _BOOKS[book, 1], _BOOKS[book, 2]
    if texture == SPINES:
        share = fade * 1.0 + (1.0 - fade) * 0.4
    else:
        share = fade * share + (1.0 - fade) * _MEAN
    rest = 1.0 - share
    return (
        rest * paint[first] + share * paint[first + INK],
        rest * paint[first + 1] + share * paint[first + INK + 1],
        rest * paint[first + 2] + share * paint[first + INK + 2],
    )


@_kernel
def part_colour(
    row: FloatArray,
    form: FloatArray,
    inverse: FloatArray,
    paint: FloatArray,
    room: FloatArray,
    x: float,
    y: float,
    t: float,
    focal: float,
    toward: Colour,
) -> Colour:
    """Return the colour of a part where a pixel's ray hits it.

    Args:
        row: Of `Visible.rows`.
        form: Of `Parts.forms`.
        inverse: Of `Parts.inverses`.
        paint: Of `Parts.paints`.
        room: Look of the room.
        x: Of the ray at optical depth 1.
        y: Of the ray at optical depth 1.
        t: Depth of the hit.
        focal: [px]
        toward: Unit vector from the hit to the eye.
    """
    px = row[ORIGIN] + t * (row[MATRIX] * x + row[MATRIX + 1] * y + row[MATRIX + 2])
    py = row[ORIGIN + 1] + t * (row[MATRIX + 3] * x + row[MATRIX + 4] * y + row[MATRIX + 5])
    pz = row[ORIGIN + 2] + t * (row[MATRIX + 6] * x + row[MATRIX + 7] * y + row[MATRIX + 8])
    kind, shade, face = int(form[KIND]), 1.0, -1
    gx, gy, gz = 0.0, 0.0, 0.0
    if kind == CUBE:
        face = _cube_face(px, py, pz)
        shade = _edge_shade(paint, face // 2, px, py, pz, focal / t)
    elif kind == BALL:
        gx, gy, gz = px, py, pz
    elif abs(pz) > 1.0 - 1e-7:
        face = 5 if pz > 0 else 4
    else:
        slope = (form[HIGH_RADIUS] - form[LOW_RADIUS]) / 2
        radius = (form[LOW_RADIUS] + form[HIGH_RADIUS]) / 2 + slope * pz
        gx, gy, gz = px, py, -slope * radius
        if form[HOLE] > 0.0 and px * px + py * py < (radius * (1.0 + form[HOLE]) / 2) ** 2:
            gx, gy, gz = -gx, -gy, -gz
            shade = 0.8
    if face >= 0:
        light, shine = paint[LIGHTS + face], 0.0
    else:
        light, shine = _round_light(inverse, paint, room, gx, gy, gz, toward)
    red, green, blue = _surface(paint, face, kind, px, py, pz, t * paint[DENSITY] / focal)
    light, shine = light * shade, shine * room[DIFFUSE]
    return (
        (red * light + shine) * room[TINT],
        (green * light + shine) * room[TINT + 1],
        (blue * light + shine) * room[TINT + 2],
    )


@_kernel
def wall_colour(room: FloatArray, side: int, along: float, z: float, width: float) -> Colour:
    """Return the colour of a wall's face.

    Args:
        room: Look of the room.
        side: 0 to 3 for −x, +x, −y, +y; 5 for the top.
        along: Coordinate along the face [m].
        z: Height [m].
        width: Side of a pixel there [m].
    """
    sign = 1.0 if side % 2 else -1.0
    light = light_on(room, sign if side < 2 else 0.0, sign if 2 <= side < 4 else 0.0, 1.0 if side > 3 else 0.0)
    if z < room[SKIRTING + 3]:
        red, green, blue = room[SKIRTING], room[SKIRTING + 1], room[SKIRTING + 2]
    else:
        cells = max(room[WALL_LOOK + REPEAT_U], room[WALL_LOOK + REPEAT_V])
        red, green, blue = mix(room, WALL_LOOK, along, z, width * cells)
    return red * light * room[TINT], green * light * room[TINT + 1], blue * light * room[TINT + 2]


@_kernel
def floor_colour(room: FloatArray, x: float, y: float, width: float) -> Colour:
    """Return the colour of the floor at a point of the map; ``width`` is the side of a pixel there [m]."""
    light = light_on(room, 0.0, 0.0, 1.0)
    cells = max(room[FLOOR_LOOK + REPEAT_U], room[FLOOR_LOOK + REPEAT_V])
    red, green, blue = mix(room, FLOOR_LOOK, x, y, width * cells)
    return red * light * room[TINT], green * light * room[TINT + 1], blue * light * room[TINT + 2]


@_kernel
def _cube_face(x: float, y: float, z: float) -> int:
    """Return which face of the cube a point on it is on."""
    ax, ay, az = abs(x), abs(y), abs(z)
    if ax >= ay and ax >= az:
        return 1 if x > 0 else 0
    if ay >= az:
        return 3 if y > 0 else 2
    return 5 if z > 0 else 4


@_kernel
def _edge_shade(paint: FloatArray, axis: int, x: float, y: float, z: float, pixels: float) -> float:
    """Return how bright a point of a cube's face is: dark near the edges, so that boxes show their shape."""
    near = 0.0
    if axis != 0 and 1.0 - abs(x) < paint[EDGES]:
        near = 1.0
    if axis != 1 and 1.0 - abs(y) < paint[EDGES + 1]:
        near = 1.0
    if axis != 2 and 1.0 - abs(z) < paint[EDGES + 2]:
        near = 1.0
    return 1.0 - near * (1.0 - _EDGE_SHADE) * min(0.01 * pixels, 1.0)  # an edge narrower than a pixel is fainter


@_kernel
def _round_light(
    inverse: FloatArray, paint: FloatArray, room: FloatArray, gx: float, gy: float, gz: float, toward: Colour
) -> tuple[float, float]:
    """Return light and shine of a round surface whose gradient in the part's space is given."""
    nx = inverse[0] * gx + inverse[3] * gy + inverse[6] * gz
    ny = inverse[1] * gx + inverse[4] * gy + inverse[7] * gz
    nz = inverse[2] * gx + inverse[5] * gy + inverse[8] * gz
    scale = 1.0 / math.sqrt(max(nx * nx + ny * ny + nz * nz, 1e-300))
    nx, ny, nz = nx * scale, ny * scale, nz * scale
    light = light_on(room, nx, ny, nz)
    if paint[GLOSS] <= 0.0:
        return light, 0.0
    hx, hy, hz = room[LAMP] + toward[0], room[LAMP + 1] + toward[1], room[LAMP + 2] + toward[2]
    peak = (nx * hx + ny * hy + nz * hz) / math.sqrt(max(hx * hx + hy * hy + hz * hz, 1e-300))
    peak = max(peak, 0.0) ** 4
    return light, 220.0 * paint[GLOSS] * peak**6


@_kernel
def _surface(paint: FloatArray, face: int, kind: int, x: float, y: float, z: float, width: float) -> Colour:
    """Return the unlit colour at a point of a part's space on its surface."""
    if int(paint[TEXTURE]) == PLAIN or (face >= 0 and not (int(paint[FACES]) >> face) & 1):
        return paint[0], paint[1], paint[2]
    if face < 0 and not (int(paint[FACES]) >> 6) & 1:
        return paint[0], paint[1], paint[2]
    u, v = (x + 1.0) / 2, (y + 1.0) / 2
    if face < 0:
        u, v = math.atan2(y, x) / (2 * math.pi) + 0.5, (z + 1.0) / 2
    elif face < 2:
        u, v = v, (z + 1.0) / 2
    elif face < 4:
        v = (z + 1.0) / 2
    return mix(paint, 0, u, v, width)
