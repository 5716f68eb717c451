"""Which categories come in many colours, and which of their pairs training leaves out or says nothing of."""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Iterable

Pair = tuple[str, str]
"""Names of a colour and a category."""
_MANY = 6


def many_coloured(pairs: Iterable[Pair]) -> frozenset[str]:
    """Return the categories that come in six colours or more: paint does not make them what they are.

    Args:
        pairs: What is seen; an empty colour is none.
    """
    counts = Counter(category for colour, category in set(pairs) if colour)
    return frozenset(category for category, count in counts.items() if count >= _MANY)


def held_out_pairs(pairs: Iterable[Pair]) -> frozenset[Pair]:
    """Return the pairs that training leaves out: a tenth, told by a checksum, of those of many-coloured categories."""
    seen = frozenset(pairs)
    many = many_coloured(seen)
    return frozenset(
        (colour, category)
        for colour, category in seen
        if colour and category in many and zlib.crc32(f"{colour} {category}".encode()) % 10 == 0
    )


def untold_pairs(pairs: Iterable[Pair]) -> frozenset[Pair]:
    """Return the pairs that are never seen of categories that come in many colours: they may well exist.

    Training must not learn from their absence. Otherwise whoever saw grey sofas but no white one learns that what has
    a sofa's shape is grey, however bright.
    """
    seen = frozenset(pairs)
    colours = frozenset(colour for colour, _ in seen if colour)
    return frozenset((colour, category) for category in many_coloured(seen) for colour in colours) - seen
