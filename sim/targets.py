"""Which instances of a world, or of what a frame shows, a text means."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import chain
from typing import NamedTuple

from sim.frame import InstanceView
from sim.perception.words import normal_name, parse_text
from sim.world import World

Similarity = Callable[[str, str], float]
"""Of two names, 1 for the same."""
SAME_THING = 0.8
"""Similarity of two names from which they are taken for synonyms."""


class _Thing(NamedTuple):
    id: str
    category: str
    colour: str | None


def instances_named(world: World, text: str, similarity: Similarity) -> frozenset[str]:
    """Return the ids of the objects and the furniture that a text names.

    Args:
        world: Where to look.
        text: For example "the red wallet"; a colour counts only for things that have one.
        similarity: Of two names, 1 for the same.

    Returns:
        Ids, none if nothing in the world is meant.
    """
    objects = (_Thing(thing.id, thing.category, thing.colour) for thing in world.objects)
    furniture = (_Thing(piece.id, piece.category, piece.colour) for piece in world.furniture)
    return _named(chain(objects, furniture), text, similarity)


def views_named(views: Iterable[InstanceView], text: str, similarity: Similarity) -> frozenset[str]:
    """Return the ids of the instances in sight that a text names.

    As `instances_named`, but only what is in sight is known: a synonym is taken for the thing even if a thing of the
    very name is elsewhere.
    """
    return _named((_Thing(view.id, view.category, view.colour) for view in views), text, similarity)


def _named(things: Iterable[_Thing], text: str, similarity: Similarity) -> frozenset[str]:
    query, things = parse_text(text), tuple(things)
    names = {thing.category for thing in things}
    exact = {name for name in names if normal_name(name) == query.noun}
    meant = exact or {name for name in names if similarity(name, query.noun) >= SAME_THING}
    return frozenset(t.id for t in things if t.category in meant and query.colour in (None, t.colour))
