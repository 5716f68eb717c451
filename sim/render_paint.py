"""Colours that texts and worlds may name."""

from __future__ import annotations

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


def basic_colour(word: str) -> str | None:
    """Return the colour a word names, or None if it names none."""
    word = COLOUR_SPELLINGS.get(word, word)
    return word if word in COLOURS else None
