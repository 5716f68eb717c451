"""Text on pictures, placed where it hides little."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from zavis_bt.recording.canvas import Colour
from zavis_bt.types import FloatArray

if TYPE_CHECKING:
    from PIL import ImageDraw, ImageFont

_PADDING = 4  # around the text inside its plate [px]
_DIRECTIONS = np.array([[1, 0], [-1, 0], [0, -1], [0, 1], [0.7, -0.7], [-0.7, -0.7], [0.7, 0.7], [-0.7, 0.7]])
_STEPS = (0.0, 12.0, 26.0, 44.0, 66.0)  # how far a label may move away from its mark [px]


@dataclass(frozen=True, slots=True)
class Label:
    """A text that belongs to a mark."""

    text: str
    anchor: tuple[float, float]
    """Middle of the mark [px]."""
    gap: float
    """Radius of the mark, which the text keeps clear of [px]."""
    detail: str = ""
    """Follows the text, in grey."""
    colour: Colour = (30, 36, 48)
    plate: Colour = (255, 255, 255)
    size: int = 15


@lru_cache(maxsize=32)
def font(size: int) -> ImageFont.FreeTypeFont:
    """Return Pillow's own font, so that pictures look the same everywhere; ``size`` [px]."""
    from PIL import ImageFont

    loaded = ImageFont.load_default(size=size)
    assert isinstance(loaded, ImageFont.FreeTypeFont)  # Pillow's wheels carry FreeType
    return loaded


def text_width(text: str, size: int) -> float:
    """Return the width of a text [px]."""
    return float(font(size).getlength(text))


def place(labels: Sequence[Label], obstacles: FloatArray, bounds: tuple[float, float]) -> FloatArray:
    """Choose a place for each label, one after another.

    Args:
        labels: What to place, the most important first.
        obstacles: (m, 4) rectangles u0, v0, u1, v1 that should stay visible [px].
        bounds: Width and height of the picture [px].

    Returns:
        (n, 4) rectangles of the labels with their plates [px].
    """
    taken = np.empty((0, 4))
    for label in labels:
        options, distances = _options(label)
        cost = distances + 0.05 * _overlap(options, obstacles) + 0.5 * _overlap(options, taken)
        outside = np.maximum(-options[:, :2], 0).sum(axis=1) + np.maximum(options[:, 2:] - bounds, 0).sum(axis=1)
        best = options[np.argmin(cost + 10 * outside)]
        taken = np.vstack((taken, best))
    return taken


def draw(pen: ImageDraw.ImageDraw, label: Label, rectangle: FloatArray) -> None:
    """Draw a label, with a line to its mark if it stands apart."""
    u0, v0, u1, v1 = (float(edge) for edge in rectangle)
    nearest = np.clip(label.anchor, (u0, v0), (u1, v1))
    offset = nearest - label.anchor
    distance = float(np.hypot(*offset))
    if distance > label.gap + 8:
        edge = label.anchor + offset * (label.gap / distance)
        pen.line([*edge, *nearest], fill=(120, 128, 142), width=1)
    pen.rounded_rectangle((u0, v0, u1, v1), radius=4, fill=(*label.plate, 235))
    baseline = v1 - _PADDING - 0.18 * label.size
    pen.text((u0 + _PADDING, baseline), label.text, fill=label.colour, font=font(label.size), anchor="ls")
    if label.detail:
        after = u0 + _PADDING + text_width(label.text + " ", label.size)
        pen.text((after, baseline), label.detail, fill=(112, 120, 134), font=font(label.size - 3), anchor="ls")


def _options(label: Label) -> tuple[FloatArray, FloatArray]:
    width = text_width(label.text, label.size) + 2 * _PADDING
    if label.detail:
        width += text_width(" ", label.size) + text_width(label.detail, label.size - 3)
    half = np.array([width / 2, label.size / 2 + _PADDING])
    centres, distances = [], []
    for step in _STEPS:
        for preference, direction in enumerate(_DIRECTIONS):
            centres.append(np.array(label.anchor) + direction * (half + label.gap + 2 + step))
            distances.append(step + preference)
    middle = np.array(centres)
    return np.hstack((middle - half, middle + half)), np.array(distances)


def _overlap(options: FloatArray, rectangles: FloatArray) -> FloatArray:
    if not len(rectangles):
        return np.zeros(len(options))
    a, b = options[:, None], rectangles[None]
    extent = np.minimum(a[..., 2:], b[..., 2:]) - np.maximum(a[..., :2], b[..., :2])
    return np.asarray(np.clip(extent, 0, None).prod(axis=2).sum(axis=1))
