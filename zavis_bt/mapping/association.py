"""Which sighting shows which landmark."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from zavis_bt.mapping.evidence import Evidence


@dataclass(frozen=True, slots=True)
class AssociationSettings:
    """When two things seen are one, judged by the distance of their middles relative to their sizes, and by label.

    The reach of a pair is ``slack`` plus the larger of the two radii: seen from another side, or in part, the middle
    of what is seen of a thing lies up to about its radius away. Two equal things side by side are two radii apart.
    """

    slack: float = 0.25
    """What localisation and depth may be wrong by [m]."""
    min_similarity: float = 0.3
    """Least cosine between the label distributions of things within reach."""
    same_place: float = 0.35
    """Share of the reach below which things of similar size are one whatever the labels say, …"""
    size_ratio: float = 2.0
    """… where similar means that neither radius is more than this many times the other."""
    duplicate: float = 0.5
    """Share of the reach below which two landmarks with the same label turn out to be one."""


def closeness(a: Evidence, b: Evidence, settings: AssociationSettings) -> float:
    """Return the horizontal distance of two middles as a share of the pair's reach."""
    return math.dist(a.position[:2], b.position[:2]) / (settings.slack + max(a.radius, b.radius))


def cost(a: Evidence, b: Evidence, settings: AssociationSettings) -> float:
    """Return how badly two pieces of evidence suit each other, from 0; inf if they show different things."""
    distance, similarity = closeness(a, b, settings), a.similarity(b)
    if is_same_place(a, b, settings) or (distance <= 1 and similarity >= settings.min_similarity):
        return distance + 1 - similarity
    return math.inf


def is_same_place(a: Evidence, b: Evidence, settings: AssociationSettings) -> bool:
    """Tell whether two things lie so much in the same place, height included, that they must be one."""
    small, large = sorted((a.radius, b.radius))
    reach = settings.slack + large
    similar = large <= settings.size_ratio * small + 1e-9
    return similar and math.dist(a.position, b.position) <= settings.same_place * reach


def is_duplicate(a: Evidence, b: Evidence, settings: AssociationSettings) -> bool:
    """Tell whether two landmarks are one: they overlap and have the same label."""
    return a.label == b.label and closeness(a, b, settings) <= settings.duplicate


def assign(seen: Sequence[Evidence], known: Sequence[Evidence], settings: AssociationSettings) -> list[int | None]:
    """Match what one frame shows with the landmarks, the best pairs first, one to one.

    Two things in one frame are two things, so no landmark takes both.

    Args:
        seen: The frame's sightings.
        known: The landmarks.
        settings: Limits.

    Returns:
        For each sighting the index of its landmark, or None.
    """
    pairs = [(cost(s, k, settings), i, j) for i, s in enumerate(seen) for j, k in enumerate(known)]
    matches: list[int | None] = [None] * len(seen)
    taken: set[int] = set()
    for value, i, j in sorted(pairs):
        if math.isfinite(value) and matches[i] is None and j not in taken:
            matches[i] = j
            taken.add(j)
    return matches
