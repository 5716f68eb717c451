"""Where a ray enters a part or meets a wall's face; infinite where it misses.

All functions are without branches as far as can be, so that loops over them are vectorised. A ray that starts within
a part does not hit it.
"""

from __future__ import annotations

import math

from numba import njit

_TINY = 1e-12  # stands for a direction component of zero, so that divisions stay finite

_kernel = njit(cache=True, nogil=True, error_model="numpy")


@_kernel
def cube_entry(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float) -> float:
    """Return where a ray from o along d enters the cube from -1 to 1."""
    ix = 1.0 / (dx if abs(dx) > _TINY else _TINY)
    iy = 1.0 / (dy if abs(dy) > _TINY else _TINY)
    iz = 1.0 / (dz if abs(dz) > _TINY else _TINY)
    mx, my, mz = -ox * ix, -oy * iy, -oz * iz  # where it passes the middle planes
    hx, hy, hz = abs(ix), abs(iy), abs(iz)
    entry = max(max(mx - hx, my - hy), mz - hz)
    leave = min(min(mx + hx, my + hy), mz + hz)
    return entry if (entry <= leave) & (entry > 0.0) else math.inf


@_kernel
def ball_entry(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float) -> float:
    """Return where a ray enters the ball of radius 1."""
    a, b = dx * dx + dy * dy + dz * dz, ox * dx + oy * dy + oz * dz
    inside = b * b - a * (ox * ox + oy * oy + oz * oz - 1.0)
    entry = (-b - math.sqrt(max(inside, 0.0))) / a
    return entry if (inside >= 0.0) & (entry > 0.0) else math.inf


@_kernel
def cylinder_entry(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float) -> float:
    """Return where a ray enters the cylinder of radius 1 about the third axis, from -1 to 1."""
    iz = 1.0 / (dz if abs(dz) > _TINY else _TINY)
    mz, hz = -oz * iz, abs(iz)
    a, b = max(dx * dx + dy * dy, _TINY * _TINY), ox * dx + oy * dy
    inside = b * b - a * (ox * ox + oy * oy - 1.0)
    reach = math.sqrt(max(inside, 0.0))
    entry = max((-b - reach) / a, mz - hz)
    leave = min((-b + reach) / a, mz + hz)
    return entry if (inside >= 0.0) & (entry <= leave) & (entry > 0.0) else math.inf


@_kernel
def round_entry(
    ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, low: float, high: float, hole: float
) -> float:
    """Return where a ray enters a body of changing radius, perhaps with a hole: its sides or its ends."""
    dz = dz if abs(dz) > _TINY else _TINY
    middle, slope = (low + high) / 2, (high - low) / 2
    entry = min(_end_entry(ox, oy, oz, dx, dy, dz, low, high, hole), _side_entry(ox, oy, oz, dx, dy, dz, middle, slope))
    if hole > 0.0:
        entry = min(entry, _side_entry(ox, oy, oz, dx, dy, dz, middle * hole, slope * hole))
    return entry


@_kernel
def wall_entry(ahead: float, along: float, up: float, away: float, low: float, high: float, top: float) -> float:
    """Return where a ray meets a wall's face.

    Args:
        ahead: Its direction across the face's plane.
        along: Its direction along the face.
        up: Its direction upwards.
        away: Distance of the plane.
        low: Where the face begins, along.
        high: Where it ends.
        top: Where its top is.
    """
    t = away / (ahead if abs(ahead) > _TINY else _TINY)
    place = t * along
    return t if (t > 0.0) & (place >= low) & (place <= high) & (t * up <= top) else math.inf


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
def _side_entry(ox: float, oy: float, oz: float, dx: float, dy: float, dz: float, middle: float, slope: float) -> float:
    """Return where a ray first meets the side of radius ``middle + slope z`` for z from -1 to 1, inf if it does not."""
    radius, change = middle + slope * oz, slope * dz
    a, b = dx * dx + dy * dy - change * change, ox * dx + oy * dy - radius * change
    inside = b * b - a * (ox * ox + oy * oy - radius * radius)
    if inside < 0.0:
        return math.inf
    a = a if abs(a) > _TINY * _TINY else _TINY * _TINY
    reach, entry = math.sqrt(inside), math.inf
    for t in ((-b - reach) / a, (-b + reach) / a):
        if t > 0.0 and abs(oz + t * dz) <= 1.0:
            entry = min(entry, t)
    return entry
