"""Which instances of a world a text means."""

from __future__ import annotations

from collections.abc import Callable

from sim.perception.words import normal_name, parse_text
from sim.world import World

SAME_THING = 0.8
"""Similarity of two names from which they are taken for synonyms."""


def instances_named(world: World, text: str, similarity: Callable[[str, str], float]) -> frozenset[str]:
    """Return the ids of the objects and the furniture that a text names.

    Args:
        world: Where to look.
        text: For example "the red wallet"; a colour counts only for things that have one.
        similarity: Of two names, 1 for the same.

    Returns:
        Ids, none if nothing in the world is meant.
    """
    query = parse_text(text)
    names = {thing.category for thing in world.objects} | {piece.category for piece in world.furniture}
    exact = {name for name in names if normal_name(name) == query.noun}
    meant = exact or {name for name in names if similarity(name, query.noun) >= SAME_THING}
    objects = (o.id for o in world.objects if o.category in meant and query.colour in (None, o.colour))
    furniture = (piece.id for piece in world.furniture if piece.category in meant and query.colour is None)
    return frozenset((*objects, *furniture))
