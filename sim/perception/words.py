"""Names, nouns and colours in texts."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import NamedTuple

from sim.render_paint import basic_colour

_PROMPT = re.compile(r"^(an? |the )?(photo|picture|image) of ")
_FILLERS = frozenset({"a", "an", "the", "my", "some", "colored", "coloured"})


class TextQuery(NamedTuple):
    """What a text asks for."""

    noun: str
    """Everything but the colour, in lower case."""
    colour: str | None
    """A basic colour's name."""


@lru_cache(maxsize=4096)
def parse_text(text: str) -> TextQuery:
    """Return noun and colour of a text such as "red wallet" or "A photo of a red wallet"."""
    words = re.findall(r"[\w'-]+", _PROMPT.sub("", normal_name(text)))
    colours = [colour for colour in map(basic_colour, words) if colour]
    noun = " ".join(word for word in words if basic_colour(word) is None and word not in _FILLERS)
    return TextQuery(noun, colours[0] if colours else None)


def normal_name(name: str) -> str:
    """Return a name in lower case with single blanks."""
    return " ".join(name.lower().split())
