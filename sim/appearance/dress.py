"""Dresses a world: turns its boxes into the parts that the camera sees."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sim.appearance.catalogue import shape_of
from sim.appearance.facing import orientations
from sim.appearance.look import Look, look_of
from sim.appearance.palette import GLOSS, SLOTS
from sim.appearance.shape import EVERYWHERE, Part, Pattern, Shape
from sim.render_parts import CUBE, Parts
from sim.render_shade import (
    AMBIENT,
    DENSITY,
    DIFFUSE,
    EDGES,
    FACES,
    INK,
    LAMP,
    LIGHTS,
    PAINT,
    REPEAT_U,
    REPEAT_V,
    SEED,
    TEXTURE,
)  # fmt: skip
from sim.render_shade import (
    GLOSS as GLOSS_COLUMN,
)
from sim.render_texture import TEXTURES
from sim.world import Furniture, World, WorldObject
from zavis_bt.types import FloatArray

_EDGE, _EDGE_SHARE = 0.012, 0.05  # width of dark edges [m], at most this share of the half side
_AXES = {"x": 0, "y": 1, "z": 2}
_FINISH_CELLS = {
    "wood": (3.0, 1.4),
    "weave": (60.0, 14.0),
    "leather": (22.0, 5.0),
    "marble": (6.0, 1.5),
    "speckle": (40.0, 14.0),
}
"""Cells of a material's pattern per metre, and at least over the whole thing."""
_FINISH_REPEAT = 5.0  # cells of other patterns over the whole thing


class Template(NamedTuple):
    """A variant of a shape as arrays over its p parts."""

    spans: FloatArray
    """(p, 3, 2)"""
    turns: FloatArray
    """(p, 3, 3) from a round part's own axes to the shape's; columns."""
    leans: FloatArray
    """(p, 3, 3) shear in the shape's space."""
    forms: FloatArray
    """(p, 4)"""
    slots: np.ndarray
    """(p, 2) of colour and second colour."""
    patterns: FloatArray
    """(p, 5) texture, repeats, faces, whether these are per metre."""
    gloss: FloatArray
    """(p,)"""
    bare: np.ndarray
    """(p,) whether the body's finish shows on the part."""


def dress(world: World, lamp: FloatArray) -> tuple[Parts, tuple[Look, ...]]:
    """Return the parts of all furniture and objects of a world, and their looks.

    Args:
        world: What there is.
        lamp: Columns of the room's look.
    """
    things: tuple[Furniture | WorldObject, ...] = (*world.furniture, *world.objects)
    boxes = _boxes(world)
    shapes = [shape_of(thing.category) for thing in things]
    turns = orientations(world, boxes, shapes)
    looks = tuple(look_of(thing.category, thing.colour, world.name, thing.id, thing.appearance) for thing in things)
    rows = [_rows(*row) for row in zip(shapes, looks, boxes, turns, strict=True)]
    first = np.concatenate(([0], np.cumsum([len(row[0]) for row in rows], dtype=np.int64))).astype(np.int32)
    frames = _stack([row[0] for row in rows], 12)
    inverses = _inverses(frames)
    paints = _stack([row[2] for row in rows], PAINT)
    _light(paints, inverses, frames, lamp)
    parts = Parts(
        first,
        np.repeat(np.arange(len(things), dtype=np.int32), np.diff(first)),
        frames,
        inverses,
        _stack([row[1] for row in rows], 4),
        paints,
        _spheres(frames, first),
    )
    for array in parts:
        array.setflags(write=False)
    return parts, looks


def _boxes(world: World) -> FloatArray:
    """Return (n, 7) middle of the base, length, width and height [m], yaw [rad] of each thing."""
    rows = [(f.x, f.y, 0.0, f.length, f.width, f.height, f.yaw) for f in world.furniture]
    rows += [(o.x, o.y, o.z, *o.size, 0.0) for o in world.objects]
    return np.array(rows, dtype=np.float64).reshape(-1, 7)


def _stack(arrays: list[FloatArray], columns: int) -> FloatArray:
    return np.vstack(arrays) if arrays else np.empty((0, columns))


@lru_cache(maxsize=512)
def template(shape: _Key) -> Template:
    """Return a variant of a shape as arrays."""
    parts = shape.parts
    turns, leans = np.zeros((len(parts), 3, 3)), np.tile(np.eye(3), (len(parts), 1, 1))
    for number, part in enumerate(parts):
        axis = _AXES[part.axis]
        for own in range(3):  # the round axis is the part's third
            turns[number, (axis + 1 + own) % 3, own] = 1.0
        if part.lean is not None:
            moved, along, share = part.lean
            leans[number, _AXES[moved], _AXES[along]] = share
    return Template(
        np.array([(part.x, part.y, part.z) for part in parts], dtype=np.float64),
        turns,
        leans,
        np.array([(part.kind, *part.taper, part.hole) for part in parts], dtype=np.float64),
        np.array([_slots(part) for part in parts]),
        np.array([_pattern(part.pattern) for part in parts], dtype=np.float64),
        np.array([_gloss(part, shape.gloss) for part in parts]),
        np.array([part.paint == "body" and part.pattern is None for part in parts]),
    )


class _Key(NamedTuple):
    parts: tuple[Part, ...]
    gloss: float


def _slots(part: Part) -> tuple[int, int]:
    ink = part.pattern.ink if part.pattern else "accent"
    return SLOTS.index(part.paint), SLOTS.index(ink)


def _pattern(pattern: Pattern | None) -> tuple[float, ...]:
    if pattern is None:
        return 0.0, 1.0, 1.0, EVERYWHERE, 0.0
    return TEXTURES.index(pattern.name), *pattern.repeat, pattern.faces, pattern.per_metre


def _gloss(part: Part, body: float) -> float:
    if part.gloss is not None:
        return part.gloss
    return body if part.paint in ("body", "trim", "accent") else GLOSS.get(part.paint, 0.0)


def _rows(shape: Shape, look: Look, box: FloatArray, turn: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return frames (p, 12), forms (p, 4) and paints (p, PAINT) of a thing."""
    table = template(_Key(shape.variants[look.variant], shape.gloss))
    half = np.abs(turn.T @ box[3:6]) / 2  # along the shape's own axes
    spans = _warped(table.spans, look.warp)
    spans[:, :2] *= half[:2, None]
    heights, tall = spans[:, 2], 2 * half[2]
    spans[:, 2] = np.minimum(heights, 1) * tall + np.maximum(heights - 1, 0) * shape.rise - half[2]
    middles, halves = spans.mean(axis=2), (spans[..., 1] - spans[..., 0]) / 2
    cos, sin = np.cos(box[6]), np.sin(box[6])
    place = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ turn
    reach = np.array([half[0], half[1], half[2]])
    shear = table.leans * reach[:, None] / np.where(halves == 0, 1, halves)[:, None, :]
    shear[:, range(3), range(3)] = 1.0
    axes = place @ (shear * halves[:, None, :]) @ table.turns
    centres = middles @ place.T + (box[0], box[1], box[2] + box[5] / 2)
    frames = np.concatenate((centres, np.swapaxes(axes, 1, 2).reshape(-1, 9)), axis=1)
    return frames, table.forms, _paints(table, look, 2 * halves)


def _warped(spans: FloatArray, warp: tuple[float, float]) -> FloatArray:
    """Return spans with bent coordinates: 0 and 1 stay, so that parts that meet go on doing so."""
    bent = np.empty_like(spans)
    bent[:, :2] = np.sign(spans[:, :2]) * np.abs(spans[:, :2]) ** warp[0]
    heights = spans[:, 2]
    bent[:, 2] = np.where(heights < 1, np.clip(heights, 0, 1) ** warp[1], heights)
    return bent


def _paints(table: Template, look: Look, sizes: FloatArray) -> FloatArray:
    paints = np.zeros((len(table.forms), PAINT))
    paints[:, :INK] = look.colours[table.slots[:, 0]]
    paints[:, INK : INK + 3] = look.colours[table.slots[:, 1]]
    paints[:, [TEXTURE, REPEAT_U, REPEAT_V, FACES]] = table.patterns[:, :4]
    long, high = np.maximum(sizes[:, 0], sizes[:, 1]), sizes[:, 2]
    metres = table.patterns[:, 4] > 0
    paints[metres, REPEAT_U] *= long[metres]
    paints[metres, REPEAT_V] *= np.maximum(high, np.minimum(sizes[:, 0], sizes[:, 1]))[metres]
    if look.finish != "plain":
        _finish(paints, table, look, sizes)
    paints[:, SEED] = look.seed + np.arange(len(paints))
    paints[:, GLOSS_COLUMN] = table.gloss
    paints[:, DENSITY] = np.maximum(paints[:, REPEAT_U], paints[:, REPEAT_V]) / np.maximum(long, high)
    return paints


def _finish(paints: FloatArray, table: Template, look: Look, sizes: FloatArray) -> None:
    """Give the body's parts their pattern, of the same scale all over the thing."""
    bare = table.bare
    largest = float(sizes.max())
    per_metre, least = _FINISH_CELLS.get(look.finish, (0.0, _FINISH_REPEAT))
    scale = max(per_metre, least / largest)
    across, deep, high = sizes[bare].T
    flat = high < 0.5 * np.minimum(across, deep)
    round_ = table.forms[bare, 0] != CUBE
    along = np.where(round_, np.pi / 2 * (across + deep), np.maximum(across, deep))
    up = np.where(flat & ~round_, np.minimum(across, deep), high)
    counts = np.maximum(np.round(scale * np.column_stack((along, up))), 1.0)
    whole = look.finish in ("stripes", "bands", "checks", "dots")  # no cut cells on these
    paints[bare, REPEAT_U : REPEAT_V + 1] = counts if whole else scale * np.column_stack((along, up))
    paints[bare, TEXTURE] = TEXTURES.index(look.finish)
    if look.finish == "wood":
        paints[np.flatnonzero(bare)[high > 1.2 * np.maximum(across, deep)], TEXTURE] = TEXTURES.index("upright wood")
    if not whole:
        body = look.colours[0]
        paints[bare, INK : INK + 3] = 0.8 * body if body.mean() > 70 else 1.25 * body + 14


def _inverses(frames: FloatArray) -> FloatArray:
    """Return (m, 12) the ways back from the map to the parts' spaces."""
    if len(frames) == 0:
        return np.empty((0, 12))
    matrices = np.linalg.inv(np.swapaxes(frames[:, 3:].reshape(-1, 3, 3), 1, 2))
    offsets = -np.einsum("nij,nj->ni", matrices, frames[:, :3])
    return np.ascontiguousarray(np.concatenate((matrices.reshape(-1, 9), offsets), axis=1))


def _light(paints: FloatArray, inverses: FloatArray, frames: FloatArray, room: FloatArray) -> None:
    """Write the light on the flat faces of the parts, and the widths of their edges."""
    normals = inverses[:, :9].reshape(-1, 3, 3)
    lengths = np.linalg.norm(normals, axis=2)
    facing = 0.5 * (normals @ room[0, LAMP : LAMP + 3]) / np.maximum(lengths, 1e-300)
    for axis in range(3):
        for side, sign in enumerate((-1, 1)):
            paints[:, LIGHTS + 2 * axis + side] = room[0, AMBIENT] + room[0, DIFFUSE] * (0.5 + sign * facing[:, axis])
    halves = np.linalg.norm(frames[:, 3:].reshape(-1, 3, 3), axis=2)
    paints[:, EDGES : EDGES + 3] = np.minimum(_EDGE / np.maximum(halves, 1e-9), _EDGE_SHARE)


def _spheres(frames: FloatArray, first: np.ndarray) -> FloatArray:
    """Return (n, 4) middle and radius of a ball around the parts of each thing."""
    spheres = np.zeros((len(first) - 1, 4))
    reach = np.abs(frames[:, 3:].reshape(-1, 3, 3)).sum(axis=1)
    for thing, (begin, end) in enumerate(pairwise(first)):
        low = (frames[begin:end, :3] - reach[begin:end]).min(axis=0)
        high = (frames[begin:end, :3] + reach[begin:end]).max(axis=0)
        spheres[thing, :3], spheres[thing, 3] = (low + high) / 2, np.linalg.norm(high - low) / 2
    return spheres
