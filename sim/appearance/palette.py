"""Colours by name, and the colours materials come in."""

from __future__ import annotations

import numpy as np

from sim.render_paint import COLOURS, basic_colour
from zavis_bt.types import FloatArray

SHADES: dict[str, tuple[tuple[int, int, int], str | None]] = {
    "beige": ((206, 188, 156), "brown"),
    "cream": ((238, 228, 204), "white"),
    "silver": ((170, 174, 181), "grey"),
    "steel": ((150, 156, 164), "grey"),
    "charcoal": ((54, 56, 62), "black"),
    "gold": ((206, 166, 72), "yellow"),
    "brass": ((178, 148, 78), "yellow"),
    "oak": ((184, 142, 94), "brown"),
    "pine": ((212, 176, 126), "brown"),
    "walnut": ((106, 72, 48), "brown"),
    "mahogany": ((112, 56, 40), "brown"),
    "tan": ((176, 128, 84), "brown"),
    "cardboard": ((172, 130, 86), "brown"),
    "navy": ((34, 50, 104), "blue"),
    "sky": ((120, 172, 222), "blue"),
    "teal": ((32, 124, 128), "green"),
    "olive": ((112, 120, 58), "green"),
    "leaf": ((52, 118, 48), "green"),
    "mint": ((150, 210, 176), "green"),
    "maroon": ((116, 26, 34), "red"),
    "brick": ((168, 78, 58), "red"),
    "salmon": ((236, 148, 124), "pink"),
    "lilac": ((176, 148, 206), "purple"),
    "banana": ((242, 214, 66), "yellow"),
    "skin": ((226, 178, 140), "brown"),
    "glass": ((176, 206, 206), None),
    "screen": ((24, 34, 58), "black"),
    "glow": ((88, 150, 214), "blue"),
    "light": ((255, 244, 208), "white"),
    "ink": ((30, 30, 34), "black"),
    "paper": ((232, 228, 216), "white"),
}
"""Further names of colours, as (r, g, b) and the basic colour they belong to; clear glass has none."""

SLOTS = (
    "body", "trim", "accent", "dark", "metal", "wood", "glass", "paper", "screen", "glow", "light", "leaf", "ink",
    "fabric",
)  # fmt: skip
"""What a part may be made of. The body's colour is the thing's; trim and accent go with it."""
MATERIALS: dict[str, tuple[str, ...]] = {
    "body": ("red", "blue", "green", "yellow", "white", "black", "grey", "orange", "purple", "pink", "brown"),
    "dark": ("black", "charcoal"),
    "metal": ("silver", "steel", "grey", "brass"),
    "wood": ("oak", "pine", "walnut", "tan"),
    "glass": ("glass",),
    "paper": ("paper", "white"),
    "screen": ("screen",),
    "glow": ("glow", "sky", "mint"),
    "light": ("light",),
    "leaf": ("leaf", "green", "olive"),
    "ink": ("ink",),
    "fabric": ("cream", "white", "grey", "beige"),
}
"""What each slot is drawn from where a shape has no palette of its own for it."""
GLOSS = {"metal": 0.5, "glass": 0.8, "screen": 0.3, "dark": 0.2}
"""Of slots, 0 to 1; others have none."""


def rgb_of(name: str) -> tuple[int, int, int] | None:
    """Return the colour of a name, be it basic or a shade; None if it is no colour's."""
    word = name.lower()
    basic = basic_colour(word)
    if basic is not None:
        return COLOURS[basic]
    return SHADES[word][0] if word in SHADES else None


def basic_of(name: str) -> str | None:
    """Return the basic colour that a name belongs to, None if it is no colour's or belongs to none."""
    word = name.lower()
    return SHADES[word][1] if word in SHADES else basic_colour(word)


def trim_of(body: FloatArray) -> FloatArray:
    """Return a colour that sets details off from a body's: darker, or lighter where that is dark."""
    bright = float(body.mean())
    return body * 0.62 if bright > 75 else np.minimum(body * 1.35 + 34, 255)


def accent_of(body: FloatArray, chance: float) -> FloatArray:
    """Return the second colour of a pattern: a lighter or darker tone of the body's, so that its hue stays.

    Args:
        body: (3,) r, g, b.
        chance: 0 to 1, how far from the body's.
    """
    if float(body.sum()) > 450:
        return np.asarray(body * (0.75 - 0.2 * chance))
    return np.asarray(body + (255 - body) * (0.35 + 0.25 * chance))
