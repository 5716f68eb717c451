"""What shapes are made of: the words the tables of the catalogue are written in.

A shape fills a box: x and y run from -1 to 1, z from 0 (where it stands) to 1 (its top). The front is at y = -1, and x
is the longer side of what has one. Every part lies between two values on each axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from sim.render_parts import BALL, CUBE, ROUND, TUBE

Span = tuple[float, float]
Axis = Literal["x", "y", "z"]
Pose = Literal["upright", "lying", "longest up", "ahead"]
Where = Literal["floor", "surface"]

FRONT, BACK, SIDES, TOP, UNDER, ENDS, MANTLE = 1 << 2, 1 << 3, 0b11, 1 << 5, 1 << 4, 0b110000, 1 << 6
"""Faces of a part that have its pattern; `MANTLE` is the round side, `ENDS` the flat ends of round parts."""
EVERYWHERE = 0b1111111


@dataclass(frozen=True, slots=True)
class Pattern:
    """A pattern on a part."""

    name: str
    """One of `sim.render_texture.TEXTURES`."""
    ink: str = "dark"
    """Slot of the second colour."""
    repeat: tuple[float, float] = (1.0, 1.0)
    """How often it repeats over a face; per metre of the part if ``per_metre``."""
    faces: int = EVERYWHERE
    per_metre: bool = False


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a shape."""

    kind: int
    x: Span
    y: Span
    z: Span
    paint: str = "body"
    """Slot of its colour."""
    pattern: Pattern | None = None
    axis: Axis = "z"
    """Of round parts."""
    taper: Span = (1.0, 1.0)
    """Radius at the low and at the high end of the axis, of round parts; the larger one is 1."""
    hole: float = 0.0
    """Radius of the hole of a tube, a share of its own."""
    lean: tuple[Axis, Axis, float] | None = None
    """Shear: which coordinate moves, along which axis, by how much at the high end (as much back at the low one)."""
    gloss: float | None = None
    """0 to 1; None is that of its slot."""


def box(x: Span, y: Span, z: Span, paint: str = "body", pattern: Pattern | None = None, **more: Any) -> Part:
    """Return a block."""
    return replace(Part(CUBE, x, y, z, paint, pattern), **more)


def ball(x: Span, y: Span, z: Span, paint: str = "body", pattern: Pattern | None = None, **more: Any) -> Part:
    """Return an ellipsoid."""
    return replace(Part(BALL, x, y, z, paint, pattern), **more)


def rod(x: Span, y: Span, z: Span, paint: str = "body", pattern: Pattern | None = None, **more: Any) -> Part:
    """Return a cylinder or a cone (``taper``)."""
    return replace(Part(ROUND, x, y, z, paint, pattern), **more)


def tube(
    x: Span, y: Span, z: Span, paint: str = "body", pattern: Pattern | None = None, hole: float = 0.85, **more: Any
) -> Part:
    """Return a cylinder or cone with a hole along its axis: a ring, a wall of a cup."""
    return replace(Part(TUBE, x, y, z, paint, pattern, hole=hole), **more)


def mirrored(part: Part, *axes: Literal["x", "y"]) -> tuple[Part, ...]:
    """Return the part and its images on the other sides of the given planes."""
    parts: tuple[Part, ...] = (part,)
    for axis in axes:
        parts += tuple(_mirror(one, axis) for one in parts)
    return parts


def _mirror(part: Part, axis: Literal["x", "y"]) -> Part:
    low, high = part.x if axis == "x" else part.y
    lean, taper = part.lean, part.taper
    if lean is not None and axis in lean[:2]:
        lean = (lean[0], lean[1], -lean[2])
    if part.axis == axis:
        taper = (taper[1], taper[0])
    moved = replace(part, lean=lean, taper=taper)
    return replace(moved, x=(-high, -low)) if axis == "x" else replace(moved, y=(-high, -low))


def legs(
    top: float, width: float = 0.1, depth: float = 0.1, paint: str = "body", inset: float = 0.0
) -> tuple[Part, ...]:
    """Return four straight legs from the floor to ``top``."""
    edge = 1.0 - inset
    return mirrored(box((edge - width, edge), (edge - depth, edge), (0.0, top), paint), "x", "y")


@dataclass(frozen=True, slots=True)
class Shape:
    """How things of a category look."""

    variants: tuple[tuple[Part, ...], ...]
    """Parts; one of these is drawn for each thing."""
    size: tuple[float, float, float]
    """Of a typical one: along x, y and z [m]."""
    palette: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Colours to draw from, by slot, where not those of `sim.appearance.palette`."""
    finishes: tuple[str, ...] = ("plain",)
    """Patterns to draw from for parts of the body that have none of their own."""
    pose: Pose = "upright"
    """How it lies in its box: z up and x the longer side; flat (x the longest, z the thinnest); z the longest; or z up
    and its front towards the box's x."""
    has_front: bool = False
    """Whether it is turned with its back to the nearest wall."""
    rise: float = 0.0
    """How far parts between z = 1 and z = 2 stand out above the box [m]."""
    where: Where = "surface"
    """Where such a thing stands."""
    bears: bool = False
    """Whether things stand on it."""
    gloss: float = 0.0
    """Of the body, 0 to 1."""
    painted: bool = True
    """Whether it comes in any colour; what grows does not."""


def shape(*variants: tuple[Part | tuple[Part, ...], ...], size: tuple[float, float, float], **more: Any) -> Shape:
    """Return a shape; the variants' parts may come in groups."""
    flat = tuple(tuple(_flatten(parts)) for parts in variants)
    return replace(Shape(flat, size), **more)


def _flatten(parts: tuple[Part | tuple[Part, ...], ...]) -> list[Part]:
    flat: list[Part] = []
    for part in parts:
        flat += [part] if isinstance(part, Part) else part
    return flat
