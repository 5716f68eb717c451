"""Patterns on surfaces: how much of a second colour a point has, computed from where on its face it is.

Coordinates u and v run from 0 to 1 over a face (on round sides: around, along; on round ends: along the face's square),
``nu`` and ``nv`` say how often a pattern repeats. A pattern whose cells are smaller than pixels fades to its mean.
"""

from __future__ import annotations

import math

from numba import njit

TEXTURES = (
    "plain", "stripes", "bands", "checks", "dots", "wood", "upright wood", "weave", "speckle", "marble", "leather",
    "screen", "keys", "text", "page", "clock", "drawers", "doors", "rings", "spines", "seams", "grid", "frame",
    "label", "strip", "planks", "bricks", "digits", "picture", "rays",
)  # fmt: skip
"""Names of the patterns, in the order of their numbers."""
(
    PLAIN, STRIPES, BANDS, CHECKS, DOTS, WOOD, WOOD_UP, WEAVE, SPECKLE, MARBLE, LEATHER,
    SCREEN, KEYS, TEXT, PAGE, CLOCK, DRAWERS, DOORS, RINGS, SPINES, SEAMS, GRID, FRAME,
    LABEL, STRIP, PLANKS, BRICKS, DIGITS, PICTURE, RAYS,
) = range(len(TEXTURES))  # fmt: skip

_kernel = njit(cache=True, nogil=True, error_model="numpy")


@_kernel
def noise(i: int, j: int, seed: int) -> float:
    """Return a number from 0 to 1 that belongs to a cell."""
    h = (i * 374761393 + j * 668265263 + seed * 974711) & 0x7FFFFFFF
    h = ((h ^ (h >> 13)) * 1274126177) & 0x7FFFFFFF
    h = ((h ^ (h >> 15)) * 461845907) & 0x7FFFFFFF
    return ((h ^ (h >> 16)) & 0xFFFF) / 65535.0


@_kernel
def smooth_noise(u: float, v: float, seed: int) -> float:
    """Return a number from 0 to 1 that changes gently over cells of side 1."""
    i, j = math.floor(u), math.floor(v)
    a, b = u - i, v - j
    a, b = a * a * (3 - 2 * a), b * b * (3 - 2 * b)
    low = noise(i, j, seed) * (1 - a) + noise(i + 1, j, seed) * a
    high = noise(i, j + 1, seed) * (1 - a) + noise(i + 1, j + 1, seed) * a
    return low * (1 - b) + high * b


@_kernel
def pattern(texture: int, u: float, v: float, nu: float, nv: float, seed: int) -> float:
    """Return the share of the second colour, 0 to 1, at a point of a face."""
    if texture == PLAIN:
        return 0.0
    x, y = u * nu, v * nv
    i, j = math.floor(x), math.floor(y)
    a, b = x - i, y - j
    if texture <= LEATHER:
        return _plain_pattern(texture, x, y, a, b, i + j, seed)
    if texture <= RINGS:
        return _made_pattern(texture, u, v, a, b, i, j, nv, seed)
    return _other_pattern(texture, u, v, x, a, b, i, j, seed)


@_kernel
def _plain_pattern(texture: int, x: float, y: float, a: float, b: float, cell: int, seed: int) -> float:
    """Materials and simple repeats."""
    if texture == STRIPES:
        return 1.0 if a < 0.5 else 0.0
    if texture == BANDS:
        return 1.0 if b < 0.5 else 0.0
    if texture == CHECKS:
        return float(cell % 2)
    if texture == DOTS:
        return 1.0 if (a - 0.5) ** 2 + (b - 0.5) ** 2 < 0.09 else 0.0
    if WOOD <= texture <= WOOD_UP:  # the grain runs along u, or along v
        if texture == WOOD_UP:
            x, y = y, x
        bend = smooth_noise(x * 0.35, y * 2.0, seed)
        line = (y * 2.0 + 1.6 * bend) % 1.0
        return 0.75 * line * line + 0.25 * smooth_noise(x * 2.0, y * 18.0, seed)
    if texture == WEAVE:
        thread = 0.5 if (a < 0.5) == (b < 0.5) else 0.0
        return thread + 0.5 * smooth_noise(x * 0.3, y * 0.3, seed)
    if texture == SPECKLE:
        return 1.0 if noise(math.floor(2 * x), math.floor(2 * y), seed) > 0.7 else 0.0
    if texture == MARBLE:
        wave = x + y + 3.0 * smooth_noise(x * 0.8, y * 0.8, seed) + smooth_noise(x * 3, y * 3, seed)
        vein = abs(wave % 1.0 - 0.5) * 2.0
        return max(1.0 - 5.0 * vein, 0.0) + 0.25 * smooth_noise(x, y, seed + 1)
    return 0.6 * smooth_noise(x, y, seed) + 0.4 * smooth_noise(3 * x, 3 * y, seed)  # leather


@_kernel
def _made_pattern(texture: int, u: float, v: float, a: float, b: float, i: int, j: int, nv: float, seed: int) -> float:
    """What is written, shown or cut into a face."""
    if texture == SCREEN:
        if u < 0.04 or u > 0.96 or v < 0.05 or v > 0.95:
            return 0.0
        window = 0.1 < u < 0.62 and 0.22 < v < 0.82
        if window:
            line = (v * 14.0) % 1.0 < 0.45 and u < 0.2 + 0.4 * noise(math.floor(v * 14.0), 0, seed)
            return 0.35 if line and v < 0.72 else 1.0
        return 0.30 + 0.35 * v
    if texture == KEYS:
        return 1.0 if 0.14 < a < 0.86 and 0.16 < b < 0.84 else 0.0
    if texture == TEXT:
        ragged = 0.75 + 0.17 * noise(0, j, seed)
        return 1.0 if 0.08 < u < ragged and 0.25 < b < 0.75 and noise(math.floor(u * 34), j, seed) > 0.18 else 0.0
    if texture == PAGE:  # headline, a picture, columns of text
        if v > 0.8:
            return 1.0 if v < 0.94 and 0.07 < u < 0.93 and noise(math.floor(u * 15), 1, seed) > 0.2 else 0.0
        if 0.08 < u < 0.5 and 0.42 < v < 0.74:
            return 0.35 + 0.4 * smooth_noise(u * 9, v * 9, seed)
        column = (u * 3.0) % 1.0
        return 1.0 if 0.1 < column < 0.9 and 0.3 < b < 0.75 and v > 0.05 else 0.0
    if texture == CLOCK:
        return _clock(u - 0.5, v - 0.5, seed)
    if texture == DRAWERS:
        gap = min(min(a, 1 - a) / max(nv, 1.0), min(b, 1 - b))
        knob = (a - 0.5) ** 2 < 0.012 and (b - 0.55) ** 2 < 0.003
        return 1.0 if gap < 0.035 or knob else 0.0
    if texture == DOORS:
        frame = min(min(a, 1 - a), min(b, 1 - b))
        handle = abs(b - 0.55) < 0.07 and (abs(a - 0.9) < 0.025 if i % 2 == 0 else abs(a - 0.1) < 0.025)
        return 1.0 if frame < 0.012 or handle else 0.45 if 0.08 < frame < 0.1 else 0.0
    radius = math.hypot(u - 0.5, v - 0.5) * 2.0 * nv  # rings
    return 1.0 if radius % 1.0 < 0.5 else 0.0


@_kernel
def _clock(x: float, y: float, seed: int) -> float:
    """A dial: marks around, two hands."""
    radius = math.hypot(x, y)
    if radius > 0.47:
        return 1.0
    angle = math.atan2(x, y) / (2 * math.pi)
    if 0.36 < radius < 0.44:
        return 1.0 if abs((angle * 12.0 + 0.5) % 1.0 - 0.5) < 0.12 else 0.0
    hour, minute = 0.8 + 0.1 * noise(1, 0, seed), 0.12 + 0.1 * noise(2, 0, seed)
    for turn, length, width in ((hour, 0.22, 0.032), (minute, 0.33, 0.024)):
        c, s = math.cos(2 * math.pi * turn), math.sin(2 * math.pi * turn)
        along, across = s * x + c * y, c * x - s * y
        if -0.03 < along < length and abs(across) < width:
            return 1.0
    return 0.0


@_kernel
def _other_pattern(texture: int, u: float, v: float, x: float, a: float, b: float, i: int, j: int, seed: int) -> float:
    if texture == SPINES:
        start = 0.12 * noise(i, 3, seed)
        return -1.0 if v < 0.68 + 0.3 * noise(i, 2, seed) and start * 0.4 < a < 0.94 else 0.0
    if texture == SEAMS:  # of a ball: three lines around, one bent
        around = abs((u * 2.0) % 1.0 - 0.5)
        bent = abs(abs(v - 0.5) - 0.17 - 0.1 * math.cos(4 * math.pi * u))
        return 1.0 if around < 0.022 or abs(v - 0.5) < 0.014 or bent < 0.016 else 0.0
    if texture == GRID:
        return 1.0 if a < 0.22 or b < 0.22 else 0.0
    if texture == FRAME:
        return 1.0 if min(min(u, 1 - u), min(v, 1 - v)) < 0.09 else 0.0
    if texture == LABEL:
        return 1.0 if 0.3 < v < 0.7 and not (0.42 < v < 0.47 or 0.53 < v < 0.58) else 0.0
    if texture == STRIP:  # the magnetic strip of a card, a line of figures, a chip
        if v > 0.64 and v < 0.86:
            return 1.0
        chip = 0.1 < u < 0.28 and 0.38 < v < 0.58
        digits = 0.1 < u < 0.9 and 0.16 < v < 0.3 and (u * 19.0) % 1.0 < 0.6 and (u * 4.75) % 1.0 < 0.85
        return 0.75 if chip or digits else 0.0
    if texture == PLANKS:
        shift = noise(j, 5, seed)
        joint = (x + shift) % 1.0
        line = 1.0 if b < 0.05 or joint < 0.02 else 0.0
        return max(line, 0.55 * noise(math.floor(x + shift), j, seed) + 0.2 * smooth_noise(x * 3, b * 6 + j * 7, seed))
    if texture == BRICKS:
        joint = (x + 0.5 * (j % 2)) % 1.0
        mortar = b < 0.12 or joint < 0.06
        return 1.0 if mortar else 0.35 * noise(math.floor(x + 0.5 * (j % 2)), j, seed)
    if texture == DIGITS:
        return _digits(u, v, seed)
    if texture == PICTURE:  # sky, hills, a sun
        hill = 0.42 + 0.18 * math.sin(7 * u + 6 * noise(0, 0, seed)) + 0.06 * math.sin(19 * u)
        sun = (u - 0.3 - 0.4 * noise(1, 1, seed)) ** 2 + (v - 0.76) ** 2 < 0.01
        return 1.0 if v < hill or sun else 0.15 + 0.3 * v
    angle = math.atan2(u - 0.5, v - 0.5) / (2 * math.pi)  # rays
    return 1.0 if (angle * 8.0) % 1.0 < 0.5 else 0.0


@_kernel
def _digits(u: float, v: float, seed: int) -> float:
    """Four figures of seven bars and a colon."""
    if not (0.08 < u < 0.92 and 0.15 < v < 0.85):
        return 0.0
    x = (u - 0.08) / 0.84 * 4.0
    place, y = math.floor(x), (v - 0.15) / 0.7
    a = x - place
    if place == 1 and a > 0.9:
        return 1.0 if abs(y - 0.3) < 0.06 or abs(y - 0.7) < 0.06 else 0.0
    a = a / 0.8
    if a > 1.0:
        return 0.0
    bar = -1
    if y < 0.14:
        bar = 0
    elif y > 0.86:
        bar = 1
    elif abs(y - 0.5) < 0.07:
        bar = 2
    elif a < 0.24:
        bar = 3 if y < 0.5 else 4
    elif a > 0.76:
        bar = 5 if y < 0.5 else 6
    return 1.0 if bar >= 0 and noise(place, bar, seed) > 0.3 else 0.0
