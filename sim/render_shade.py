"""Colours of what rays hit: paint, pattern and light."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim.render_parts import BALL, CUBE, HIGH_RADIUS, HOLE, KIND, LOW_RADIUS, PLACE, PLANE, TUBE, Parts, Visible
from sim.render_rays import FLOOR, WALL, IntArray
from sim.render_texture import PLAIN, noise, pattern
from sim.visibility import View
from zavis_bt.types import FloatArray

INK, TEXTURE, REPEAT_U, REPEAT_V, SEED, FACES, GLOSS, DENSITY, EDGES, LIGHTS, PAINT = (
    3,
    6,
    7,
    8,
    9,
    10,
    11,
    12,
    13,
    16,
    22,
)
"""Columns of `Parts.paints` after the colour: second colour, pattern, its repeats over a face, its seed, bits of the
faces that have it, gloss 0 to 1, cells of the pattern per metre, widths of the dark edges along the three axes, light
on the six faces (−x, +x, −y, +y, −z, +z in the part's space)."""
LAMP, AMBIENT, DIFFUSE, TINT, WALL_LOOK, FLOOR_LOOK, SKIRTING, SKY, ROOM = 0, 3, 4, 5, 8, 18, 28, 32, 35
"""First columns of a room's look: direction to the lamp, light everywhere, light of the lamp, its colour; for walls and
floor the columns of a paint from colour to seed, with repeats per metre; the skirting's colour and height [m]; the
colour of what is above the walls."""

_EDGE_SHADE = 0.72
_BOOKS = np.array(
    [(158, 44, 42), (38, 66, 128), (52, 104, 66), (206, 178, 118),
     (92, 58, 44), (222, 214, 196), (60, 60, 66), (196, 118, 46)],
    dtype=np.float64,
)  # fmt: skip
_MEAN = 0.4  # what patterns fade to

_kernel = njit(cache=True, nogil=True, error_model="numpy")

Colour = tuple[float, float, float]
Lamp = tuple[float, float, float, float, float]
"""Direction to the lamp, light everywhere, light of the lamp."""


@_kernel
def light_on(lamp: Lamp, nx: float, ny: float, nz: float) -> float:
    """Return the light on a surface with this unit normal: half-Lambert, dim where turned away but not black."""
    return lamp[3] + lamp[4] * (0.5 + 0.5 * (nx * lamp[0] + ny * lamp[1] + nz * lamp[2]))


@_kernel
def mix(first: Colour, second: Colour, texture: int, nu: float, nv: float, seed: int, place: Colour) -> Colour:
    """Return the unlit colour at a point of a face.

    Args:
        first: Colour.
        second: Colour of the pattern.
        texture: The pattern.
        nu: Its repeats along u.
        nv: Its repeats along v.
        seed: Of the pattern.
        place: Along the face u and v, and cells of the pattern per pixel.
    """
    u, v, width = place
    share, fade = 0.0, min(max(2.0 - 2.2 * width, 0.0), 1.0)
    if fade > 0.0:
        share = pattern(texture, u, v, nu, nv, seed)
        if share < 0.0:  # a book's back
            book = int(noise(math.floor(u * nu), 9, seed) * 7.999)
            return _BOOKS[book, 0], _BOOKS[book, 1], _BOOKS[book, 2]
    share = fade * share + (1.0 - fade) * _MEAN
    rest = 1.0 - share
    return (
        rest * first[0] + share * second[0],
        rest * first[1] + share * second[1],
        rest * first[2] + share * second[2],
    )


@_kernel
def shade_room(
    look: FloatArray,
    view: View,
    visible: Visible,
    shape: tuple[int, int],
    xs: FloatArray,
    ys: FloatArray,
    seen: FloatArray,
    surfaces: IntArray,
    whose: IntArray,
    colours: FloatArray,
) -> None:
    """Fill in (h, w, 3) colours of the pixels that show walls, floor or nothing; see `sim.render_resolve.resolve`."""
    p, r, walls = view.position, view.rotation, visible.walls
    wall, wall_ink = _triple(look, 0, WALL_LOOK), _triple(look, 0, WALL_LOOK + INK)
    floor, floor_ink = _triple(look, 0, FLOOR_LOOK), _triple(look, 0, FLOOR_LOOK + INK)
    skirting, sky, tint = _triple(look, 0, SKIRTING), _triple(look, 0, SKY), _triple(look, 0, TINT)
    lamp = (look[0, LAMP], look[0, LAMP + 1], look[0, LAMP + 2], look[0, AMBIENT], look[0, DIFFUSE])
    wall_texture, wall_seed = int(look[0, WALL_LOOK + TEXTURE]), int(look[0, WALL_LOOK + SEED])
    wall_u, wall_v = look[0, WALL_LOOK + REPEAT_U], look[0, WALL_LOOK + REPEAT_V]
    floor_texture, floor_seed = int(look[0, FLOOR_LOOK + TEXTURE]), int(look[0, FLOOR_LOOK + SEED])
    floor_u, floor_v = look[0, FLOOR_LOOK + REPEAT_U], look[0, FLOOR_LOOK + REPEAT_V]
    wall_cells, floor_cells = max(wall_u, wall_v) / view.fx, max(floor_u, floor_v) / view.fx
    up, low = light_on(lamp, 0.0, 0.0, 1.0), look[0, SKIRTING + 3]
    for i in range(shape[0]):
        for j in range(shape[1]):
            surface, t = surfaces[i, j], seen[i, j]
            if surface >= 0:
                continue
            light, colour = 1.0, sky
            x, y = xs[i, j], ys[i, j]
            if surface == FLOOR:  # a pixel is stretched where the floor is seen at a slant
                px = p[0] + t * (r[0, 0] * x + r[0, 1] * y + r[0, 2])
                py = p[1] + t * (r[1, 0] * x + r[1, 1] * y + r[1, 2])
                width = t * floor_cells * max(0.5 * t / p[2], 1.0)
                colour = mix(floor, floor_ink, floor_texture, floor_u, floor_v, floor_seed, (px, py, width))
                light = up
            elif surface == WALL:
                side = int(walls[whose[i, j], PLANE]) if whose[i, j] >= 0 else 5
                axis, sign = side // 2, 2.0 * (side % 2) - 1.0
                light = light_on(lamp, sign * (axis == 0), sign * (axis == 1), sign * (axis == 2))
                along = 1 if axis == 0 else 0
                q = p[along] + t * (r[along, 0] * x + r[along, 1] * y + r[along, 2])
                pz = p[2] + t * (r[2, 0] * x + r[2, 1] * y + r[2, 2])
                colour = skirting
                if pz >= low:
                    colour = mix(wall, wall_ink, wall_texture, wall_u, wall_v, wall_seed, (q, pz, t * wall_cells))
            for k in range(3):
                colours[i, j, k] = colour[k] * light * tint[k]


@_kernel
def shade_parts(
    parts: Parts,
    look: FloatArray,
    view: View,
    visible: Visible,
    shape: tuple[int, int],
    xs: FloatArray,
    ys: FloatArray,
    seen: FloatArray,
    surfaces: IntArray,
    whose: IntArray,
    colours: FloatArray,
) -> None:
    """Fill in (h, w, 3) colours of the pixels that show things; see `sim.render_resolve.resolve`."""
    rows, forms, inverses, paints = visible.rows, parts.forms, parts.inverses, parts.paints
    r, tint = view.rotation, _triple(look, 0, TINT)
    lamp = (look[0, LAMP], look[0, LAMP + 1], look[0, LAMP + 2], look[0, AMBIENT], look[0, DIFFUSE])
    for i in range(shape[0]):
        for j in range(shape[1]):
            if surfaces[i, j] < 0:
                continue
            t, row = seen[i, j], whose[i, j]
            part, x, y = int(rows[row, PLACE]), xs[i, j], ys[i, j]
            px = rows[row, 0] + t * (rows[row, 3] * x + rows[row, 4] * y + rows[row, 5])
            py = rows[row, 1] + t * (rows[row, 6] * x + rows[row, 7] * y + rows[row, 8])
            pz = rows[row, 2] + t * (rows[row, 9] * x + rows[row, 10] * y + rows[row, 11])
            kind, face, shade, gz = int(forms[part, KIND]), -1, 1.0, pz
            side = 1.0  # −1 within a hole, whose surface faces the axis
            if kind == CUBE:
                face = _cube_face(px, py, pz)
                edges = (paints[part, EDGES], paints[part, EDGES + 1], paints[part, EDGES + 2])
                shade = _edge_shade(edges, face // 2, px, py, pz, view.fx / t)
            elif kind != BALL:
                if abs(pz) > 1.0 - 1e-7:
                    face = 5 if pz > 0.0 else 4
                else:
                    slope = (forms[part, HIGH_RADIUS] - forms[part, LOW_RADIUS]) / 2
                    radius = (forms[part, LOW_RADIUS] + forms[part, HIGH_RADIUS]) / 2 + slope * pz
                    gz, middle = -slope * radius, radius * (1.0 + forms[part, HOLE]) / 2
                    if kind == TUBE and px * px + py * py < middle * middle:
                        side, shade = -1.0, 0.8
            light, shine = 0.0, 0.0
            if face >= 0:
                light = paints[part, LIGHTS + face]
            else:
                gx, gy, gz = side * px, side * py, side * gz
                nx = inverses[part, 0] * gx + inverses[part, 3] * gy + inverses[part, 6] * gz
                ny = inverses[part, 1] * gx + inverses[part, 4] * gy + inverses[part, 7] * gz
                nz = inverses[part, 2] * gx + inverses[part, 5] * gy + inverses[part, 8] * gz
                scale = 1.0 / math.sqrt(max(nx * nx + ny * ny + nz * nz, 1e-300))
                nx, ny, nz = nx * scale, ny * scale, nz * scale
                light, gloss = light_on(lamp, nx, ny, nz), paints[part, GLOSS]
                if gloss > 0.0:
                    dx = r[0, 0] * x + r[0, 1] * y + r[0, 2]
                    dy = r[1, 0] * x + r[1, 1] * y + r[1, 2]
                    dz = r[2, 0] * x + r[2, 1] * y + r[2, 2]
                    shine = gloss * _shine(lamp, nx, ny, nz, dx, dy, dz)
            red, green, blue = paints[part, 0], paints[part, 1], paints[part, 2]
            texture, bit = int(paints[part, TEXTURE]), face if face >= 0 else 6
            if texture != PLAIN and (int(paints[part, FACES]) >> bit) & 1:
                ink = (paints[part, INK], paints[part, INK + 1], paints[part, INK + 2])
                u, v = _place_on(face, px, py, pz)
                red, green, blue = mix(
                    (red, green, blue),
                    ink,
                    texture,
                    paints[part, REPEAT_U],
                    paints[part, REPEAT_V],
                    int(paints[part, SEED]),
                    (u, v, t * paints[part, DENSITY] / view.fx),
                )
            light *= shade
            colours[i, j, 0] = (red * light + shine) * tint[0]
            colours[i, j, 1] = (green * light + shine) * tint[1]
            colours[i, j, 2] = (blue * light + shine) * tint[2]


@_kernel
def _triple(table: FloatArray, row: int, first: int) -> Colour:
    return table[row, first], table[row, first + 1], table[row, first + 2]


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
def _edge_shade(edges: Colour, axis: int, x: float, y: float, z: float, pixels: float) -> float:
    """Return how bright a point of a cube's face is: dark near the edges, so that boxes show their shape."""
    near = axis != 0 and 1.0 - abs(x) < edges[0]
    near |= axis != 1 and 1.0 - abs(y) < edges[1]
    near |= axis != 2 and 1.0 - abs(z) < edges[2]
    return 1.0 - near * (1.0 - _EDGE_SHADE) * min(0.01 * pixels, 1.0)  # an edge narrower than a pixel is fainter


@_kernel
def _shine(lamp: Lamp, nx: float, ny: float, nz: float, dx: float, dy: float, dz: float) -> float:
    """Return what a glossy surface reflects of the lamp, for a ray of direction d (Blinn and Phong)."""
    scale = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
    hx, hy, hz = lamp[0] - dx * scale, lamp[1] - dy * scale, lamp[2] - dz * scale
    peak = (nx * hx + ny * hy + nz * hz) / math.sqrt(max(hx * hx + hy * hy + hz * hz, 1e-300))
    peak = max(peak, 0.0) ** 2
    peak *= peak
    peak *= peak
    return 220.0 * lamp[4] * peak * peak * peak


@_kernel
def _place_on(face: int, x: float, y: float, z: float) -> tuple[float, float]:
    """Return where on a face a point of the part's space is, u and v from 0 to 1."""
    if face < 0:
        return math.atan2(y, x) / (2 * math.pi) + 0.5, (z + 1.0) / 2
    if face < 2:
        return (y + 1.0) / 2, (z + 1.0) / 2
    if face < 4:
        return (x + 1.0) / 2, (z + 1.0) / 2
    return (x + 1.0) / 2, (y + 1.0) / 2
