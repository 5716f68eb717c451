"""The simulated text-image matcher."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from sim.frame import InstanceView, instances_of
from sim.perception.curves import MatcherSettings, crop_quality, name_fit
from sim.perception.draws import Draws, frame_key, key_of, keys_of
from sim.perception.words import TextQuery, normal_name, parse_text
from zavis_bt.types import Box, FloatArray, RgbdFrame

_MARGIN = 2.0  # [px] of context around a crop; keeps boxes a few pixels high comparable
_LEAST_OVERLAP = 0.25  # IoU at which a box shows an instance
_PART_COVER, _PART_OVERLAP = 0.6, 0.4  # share of a box inside furniture that makes it a part of it; worth this IoU
_FAMILY = "furniture"


class SimMatcher:
    """Scores texts against boxes as an image-text model would: by the words for what the box shows."""

    def __init__(
        self,
        similarity: Callable[[str, str], float],
        rng: np.random.Generator,
        settings: MatcherSettings | None = None,
    ) -> None:
        """Set up a matcher.

        Args:
            similarity: Returns how alike two names are, −1 to 1: 1 for the same name, about 0 for unrelated ones.
            rng: Where its seed comes from.
            settings: Its scores.
        """
        self._similarity = similarity
        self._settings = settings or MatcherSettings()
        self._draws = Draws(rng)
        self._fits: dict[tuple[str, str, bool], float] = {}
        self._loose: dict[str, float] = {}

    def match(self, frame: RgbdFrame, boxes: Sequence[Box], texts: Sequence[str]) -> FloatArray:
        """Return matching scores m, shape (n_boxes, n_texts), on the 100 × cosine scale (Eq. matching_score).

        Raises:
            InputError: The frame does not come from the simulated camera.
        """
        instances, moment = instances_of(frame), frame_key(frame)
        queries, keys = [parse_text(text) for text in texts], keys_of([normal_name(text) for text in texts])
        scores = np.empty((len(boxes), len(texts)))
        for row, box in zip(scores, boxes, strict=True):
            shown, overlap = what_it_shows(box, instances)
            if shown is None:
                noise = self._draws.normal("background", keys, moment, key_of(repr(tuple(box))))
                row[:] = self._settings.background + self._settings.background_spread * noise
            else:
                noise = self._settings.instance_spread * self._draws.normal("instance", key_of(shown.id), keys)
                noise += self._settings.view_spread * self._draws.normal("view", key_of(shown.id), keys, moment)
                row[:] = self._means(shown, overlap, queries, keys) + noise
        return scores

    def _means(
        self, shown: InstanceView, overlap: float, queries: Sequence[TextQuery], keys: NDArray[np.uint64]
    ) -> FloatArray:
        """Return the mean score of each text for a crop of the instance."""
        settings = self._settings
        category = normal_name(shown.category)
        fits = np.array([self._fit(query.noun, category, shown.is_furniture) for query in queries])
        if not shown.is_furniture:
            fits = np.maximum(fits, self._resemblance(shown, queries, keys))
        quality = crop_quality(
            np.sqrt(np.array(shown.box.area)), np.array(shown.visible_fraction), np.array(overlap), settings
        )
        gains = (settings.match - settings.unrelated) * fits + self._colour_terms(shown, fits, queries)
        return np.asarray(settings.unrelated + quality * gains)

    def _colour_terms(self, shown: InstanceView, fits: FloatArray, queries: Sequence[TextQuery]) -> FloatArray:
        same, other = self._settings.same_colour, self._settings.other_colour
        colour = parse_text(shown.colour).colour if shown.colour else None
        terms = [0.0 if not q.colour or not colour else same if q.colour == colour else -other for q in queries]
        return np.where(np.array(terms) < 0, np.array(terms) * fits, terms)

    def _resemblance(self, shown: InstanceView, queries: Sequence[TextQuery], keys: NDArray[np.uint64]) -> FloatArray:
        """Return how much an object happens to look like what each text names; nothing looks like furniture."""
        low, high = self._settings.resemblance
        rate, degree = (self._draws.uniform(question, key_of(shown.id), keys) for question in ("alike", "degree"))
        loose = np.array([self._looseness(query.noun) for query in queries])
        return np.where(rate < self._settings.lookalikes * loose, low + (high - low) * degree, 0.0)

    def _looseness(self, noun: str) -> float:
        """Return 1 for the name of a loose object, 0 for the name of a piece of furniture."""
        if noun not in self._loose:
            alike = self._similarity(noun, _FAMILY) if noun else 0.0
            self._loose[noun] = float(np.clip(1.0 - alike / self._settings.half_similarity, 0.0, 1.0))
        return self._loose[noun]

    def _fit(self, noun: str, category: str, is_furniture: bool) -> float:
        """Return how well a noun names a category, 0 to 1; remembered, since the words are few."""
        pair = noun, category, is_furniture
        if pair not in self._fits:
            if not noun:
                alike = 0.0
            elif noun == category:
                alike = 1.0
            else:
                alike = max(self._similarity(noun, category), self._kinship(noun, category) if is_furniture else 0.0)
            self._fits[pair] = float(name_fit(np.array(alike), self._settings))
        return self._fits[pair]

    def _kinship(self, noun: str, category: str) -> float:
        """Return how alike two pieces of furniture are as such: a desk and a side table look alike, whatever the words.

        The geometric mean of how much each is a piece of furniture.
        """
        one, two = self._similarity(noun, _FAMILY), self._similarity(category, _FAMILY)
        return float(np.sqrt(max(one, 0.0) * max(two, 0.0)))


def what_it_shows(box: Box, instances: Sequence[InstanceView]) -> tuple[InstanceView | None, float]:
    """Return the instance that a box shows, and how well it sits on its visible part (IoU); None for background.

    The instance that overlaps most; a box on a part of a piece of furniture shows that piece.
    """
    best, best_overlap = None, 0.0
    for instance in instances:
        overlap = _widened(box).iou(_widened(instance.box))
        if overlap > best_overlap:
            best, best_overlap = instance, overlap
    if best is not None and best_overlap >= _LEAST_OVERLAP:
        return best, best_overlap
    for instance in instances:  # nearest first
        if instance.is_furniture and box.intersection(instance.box) >= _PART_COVER * box.area > 0:
            return instance, _PART_OVERLAP
    return None, 0.0


def _widened(box: Box) -> Box:
    return Box(box.x0 - _MARGIN, box.y0 - _MARGIN, box.x1 + _MARGIN, box.y1 + _MARGIN)
