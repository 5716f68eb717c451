"""Coloured triangle meshes with their shading baked in, so that the scene looks the same under any light."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import FloatArray

Colour = tuple[int, int, int]
_SHADES = (0.86, 0.74, 1.0)  # of faces that look along x, y and z


class Solid(NamedTuple):
    """A mesh."""

    vertices: NDArray[np.float32]
    """(n, 3) [m]."""
    colours: NDArray[np.float32]
    """(n, 3), 0 to 1."""
    faces: NDArray[np.uint32]
    """(m, 3) indices."""


def merged(solids: Sequence[Solid]) -> Solid:
    """Return one mesh of several."""
    offsets = np.cumsum([0, *(len(solid.vertices) for solid in solids)])
    return Solid(
        np.concatenate([solid.vertices for solid in solids]),
        np.concatenate([solid.colours for solid in solids]),
        np.concatenate([solid.faces + np.uint32(offset) for solid, offset in zip(solids, offsets, strict=False)]),
    )


def quads(corners: FloatArray, colours: FloatArray) -> Solid:
    """Return quadrilaterals.

    Args:
        corners: (n, 4, 3) corners in order around each [m].
        colours: (n, 3), 0 to 1.
    """
    first = 4 * np.arange(len(corners), dtype=np.uint32)[:, None]
    faces = np.concatenate((first + np.array([0, 1, 2], np.uint32), first + np.array([0, 2, 3], np.uint32)))
    return Solid(
        np.asarray(corners, dtype=np.float32).reshape(-1, 3),
        np.repeat(np.asarray(colours, dtype=np.float32), 4, axis=0),
        np.asarray(faces, dtype=np.uint32),
    )


def box(low: Sequence[float], high: Sequence[float], colour: Colour) -> Solid:
    """Return an axis-aligned box between two corners [m], without its underside."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    sides = [
        [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
        [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)],
        [(x0, y1, z0), (x1, y1, z0), (x1, y1, z1), (x0, y1, z1)],
        [(x0, y0, z0), (x0, y1, z0), (x0, y1, z1), (x0, y0, z1)],
        [(x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1)],
    ]
    shades = np.array([_SHADES[2], _SHADES[1], _SHADES[1], _SHADES[0], _SHADES[0]])
    return quads(np.array(sides, dtype=np.float64), shades[:, None] * np.array(colour) / 255)


def cylinder(
    centre: Sequence[float], radius: float, height: float, colour: Colour, *, top: float | None = None, sides: int = 28
) -> Solid:
    """Return an upright cylinder that stands on ``centre`` [m]; ``top`` is its radius up there, by default the same."""
    angles = np.linspace(0, 2 * np.pi, sides + 1)
    ring = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(sides + 1)))
    base = np.array(centre, dtype=np.float64)
    low = base + radius * ring
    high = base + (radius if top is None else top) * ring + np.array([0, 0, height])
    wall = np.stack((low[:-1], low[1:], high[1:], high[:-1]), axis=1)
    shade = 0.8 + 0.1 * np.cos(angles[:-1] - 0.8)
    middle = np.broadcast_to(base + np.array([0, 0, height]), (sides, 3))
    lid = np.stack((high[:-1], high[1:], middle, middle), axis=1)
    tint = np.array(colour) / 255
    return merged([quads(wall, shade[:, None] * tint), quads(lid, np.broadcast_to(tint, (sides, 3)))])


def disc(centre: Sequence[float], radius: float, colour: Colour, *, inner: float = 0.0, sides: int = 40) -> Solid:
    """Return a flat disc, or a ring of an ``inner`` radius, facing up [m]."""
    angles = np.linspace(0, 2 * np.pi, sides + 1)
    ring = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(sides + 1)))
    outer, hole = np.array(centre) + radius * ring, np.array(centre) + inner * ring
    corners = np.stack((outer[:-1], outer[1:], hole[1:], hole[:-1]), axis=1)
    return quads(corners, np.broadcast_to(np.array(colour) / 255, (sides, 3)))


def flat(outline: FloatArray, height: float, colour: Colour) -> Solid:
    """Return a convex polygon of (n, 2) corners lying at a height [m]."""
    vertices = np.column_stack((outline, np.full(len(outline), height))).astype(np.float32)
    tint = np.full((len(outline), 3), np.array(colour) / 255, dtype=np.float32)
    others = np.arange(1, len(outline) - 1, dtype=np.uint32)
    return Solid(vertices, tint, np.column_stack((np.zeros_like(others), others, others + 1)))


def ribbon(points: FloatArray, colours: FloatArray, width: float, height: float) -> Solid:
    """Return a flat band along a polyline.

    Args:
        points: (n, 2), n ≥ 2 [m].
        colours: (n, 3) at the points, 0 to 1.
        width: [m]
        height: Above the floor [m].
    """
    along = np.gradient(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    across = np.column_stack((-along[:, 1], along[:, 0])) * width / 2
    z = np.full((len(points), 1), height)
    vertices = np.stack((np.hstack((points - across, z)), np.hstack((points + across, z))), axis=1)
    first = 2 * np.arange(len(points) - 1, dtype=np.uint32)[:, None]
    faces = np.concatenate((first + np.array([0, 1, 3], np.uint32), first + np.array([0, 3, 2], np.uint32)))
    return Solid(
        vertices.reshape(-1, 3).astype(np.float32),
        np.repeat(np.asarray(colours, dtype=np.float32), 2, axis=0),
        np.asarray(faces, dtype=np.uint32),
    )


def transformed(solid: Solid, x: float, y: float, yaw: float) -> Solid:
    """Return the mesh turned by ``yaw`` [rad] and then moved [m]."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    rotation = np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]], dtype=np.float32)
    moved = solid.vertices @ rotation + np.array([x, y, 0], dtype=np.float32)
    return Solid(moved.astype(np.float32), solid.colours, solid.faces)
