"""Colours of what is rendered: a named colour where a thing has one, else a hue of its category's own."""

from __future__ import annotations

import colorsys
import hashlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import FloatArray

COLOURS: dict[str, tuple[int, int, int]] = {
    "black": (38, 38, 42),
    "white": (240, 240, 236),
    "grey": (140, 142, 145),
    "red": (205, 42, 40),
    "orange": (238, 136, 34),
    "yellow": (240, 208, 48),
    "green": (56, 150, 70),
    "blue": (44, 92, 190),
    "purple": (126, 66, 160),
    "pink": (236, 130, 172),
    "brown": (124, 82, 50),
}
"""Names that `WorldObject.colour` and texts may use, as (r, g, b)."""
COLOUR_SPELLINGS = {"gray": "grey", "violet": "purple"}
"""Other words for the same colours."""

_LIGHT = np.array([-0.45, -0.28, 0.85])  # direction towards the lamp, map frame
_NORMALS = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]], dtype=np.float64)
_WOOD = (186, 158, 128)
_WALL, _SKY = (214, 208, 196), (226, 232, 238)
_FLOOR = ((172, 146, 116), (164, 138, 109))  # two neighbouring tiles


def basic_colour(word: str) -> str | None:
    """Return the colour a word names, or None if it names none."""
    word = COLOUR_SPELLINGS.get(word, word)
    return word if word in COLOURS else None


def category_colour(category: str) -> tuple[int, int, int]:
    """Return the (r, g, b) of a category: the same name has the same colour in every run."""
    digest = hashlib.blake2b(category.encode(), digest_size=3).digest()
    red, green, blue = colorsys.hsv_to_rgb(digest[0] / 256, 0.32 + digest[1] / 850, 0.62 + digest[2] / 900)
    return round(255 * red), round(255 * green), round(255 * blue)


def furniture_colour(category: str) -> tuple[int, int, int]:
    """Return a category's colour as furniture has it: much of it is wood, and what stands on it should stand out."""
    red, green, blue = (
        round(0.4 * own + 0.6 * wood) for own, wood in zip(category_colour(category), _WOOD, strict=True)
    )
    return red, green, blue


def object_colour(category: str, colour: str | None) -> tuple[int, int, int]:
    """Return the colour an object is painted in: its own if that has a name, else its category's."""
    named = basic_colour(colour.lower()) if colour else None
    return COLOURS[named] if named else category_colour(category)


def box_paint(colours: Sequence[tuple[int, int, int]], headings: FloatArray) -> NDArray[np.uint8]:
    """Return (n, 6, 3) the lit colour of each face.

    Args:
        colours: (r, g, b) of each of n boxes.
        headings: (n, 2) cosine and sine of their yaw.
    """
    base = np.array(colours, dtype=np.float64).reshape(-1, 1, 3)
    cos, sin = headings.T[..., None]
    normals = np.broadcast_to(_NORMALS, (len(headings), 6, 3))
    x, y, z = np.moveaxis(normals, -1, 0)
    turned = np.stack((cos * x - sin * y, sin * x + cos * y, z), axis=-1)
    return _lit(base, turned)


def room_paint() -> NDArray[np.uint8]:
    """Return (9, 3): the six faces of a wall, two floor tiles, and what is seen where there is nothing."""
    walls = _lit(np.array(_WALL, dtype=np.float64), _NORMALS)
    return np.vstack((walls, np.array([*_FLOOR, _SKY], dtype=np.uint8)))


def _lit(base: FloatArray, normals: FloatArray) -> NDArray[np.uint8]:
    """Return colours under a half-Lambert lamp: faces turned away are dim, not black."""
    facing = 0.5 + 0.5 * (normals @ (_LIGHT / np.linalg.norm(_LIGHT)))
    return np.asarray(np.clip(base * (0.55 + 0.5 * facing[..., None]), 0, 255), dtype=np.uint8)
