"""Where a target usually is, from a table of everyday knowledge generalised by word vectors."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from zavis_bt.knowledge.table import CommonsenseTable
from zavis_bt.knowledge.text import normalise
from zavis_bt.knowledge.vectors import WordVectors
from zavis_bt.types import FloatArray


class CommonsensePrior:
    """The knowledge prior p(target | landmark) from a commonsense table (Eq. co_occurrence).

    For an object of the table, p = max_i w_i · c(ℓ(place_i, landmark)) over its usual places: the paper's maximum of
    word similarities ℓ between generated places and the landmark (its printed equation has the target in the
    landmark's stead; this follows its text). The rest is our own:

    - c(ℓ) = clip((ℓ − floor) / (1 − floor), 0, 1) calibrates the cosine. 97 of 100 pairs of *different* pieces of
      furniture have a cosine below the default floor of 0.3, so that a threshold such as t_c = 0.2 separates
      "there" from "elsewhere"; equal names and synonyms have p = 1.
    - w_i = 1 − decay · i grades the places, which a table lists from the most to the less usual. ``decay=0`` gives
      the paper's ungraded maximum.
    - A target that is itself a place, such as "sofa", is at that place.
    - Any other target is taken for a mixture of the `neighbours` objects that are nearest by word vectors, as far
      as the nearest is near and the target's words are known whole; for the rest p runs from 1/2 to 1 with how many
      objects the landmark holds: what was never heard of is sought where most things are, and no landmark is
      skipped for want of knowledge.
    """

    def __init__(
        self,
        table: CommonsenseTable,
        vectors: WordVectors,
        *,
        neighbours: int = 5,
        floor: float = 0.3,
        decay: float = 0.05,
    ) -> None:
        self._table = table
        self._vectors = vectors
        self._neighbours = neighbours
        self._floor = floor
        self._objects = {name: row for row, name in enumerate(table.objects)}
        self._places = {name: column for column, name in enumerate(table.places)}
        self._usual = np.zeros((len(self._objects), len(self._places)))  # w_i of each object at each place
        for row, places in enumerate(table.objects.values()):
            for rank, place in enumerate(places):
                self._usual[row, self._places[place]] = max(1.0 - decay * rank, 0.0)
        self._closeness = lru_cache(maxsize=512)(self._compute_closeness)
        self._at_landmark = lru_cache(maxsize=512)(self._compute_at_landmark)
        self._mixture = lru_cache(maxsize=512)(self._compute_mixture)

    def probability(self, target: str, landmarks: Sequence[str]) -> FloatArray:
        """Return p(target | landmark) in [0, 1], shape (n_landmarks,)."""
        if not landmarks:
            return np.zeros(0)
        name = self._table.find(target)
        if name in self._places and name not in self._objects:
            return np.array([self._closeness(landmark)[self._places[name]] for landmark in landmarks])
        objects_at = np.stack([self._at_landmark(landmark) for landmark in landmarks], axis=1)
        if name is not None:
            located: FloatArray = objects_at[self._objects[name]]
            return located
        weights, trust = self._mixture(normalise(target))
        popularity = np.minimum(objects_at.mean(axis=0) / self._usual.mean(axis=0).max(), 1.0)
        probability: FloatArray = trust * (weights @ objects_at) + (1.0 - trust) * (1.0 + popularity) / 2.0
        return probability

    def _compute_closeness(self, landmark: str) -> FloatArray:
        """Return c(ℓ(place, landmark)) of every place, shape (n_places,)."""
        name = self._table.find(landmark)
        if name in self._places:
            landmark = name
        cosine = self._vectors.similarities(self._table.places, [landmark])[:, 0]
        calibrated = self._calibrate(cosine)
        if name in self._places:
            calibrated[self._places[name]] = 1.0
        return calibrated

    def _compute_at_landmark(self, landmark: str) -> FloatArray:
        """Return p(object | landmark) of every object of the table, shape (n_objects,)."""
        at_landmark: FloatArray = (self._usual * self._closeness(landmark)).max(axis=1)
        return at_landmark

    def _compute_mixture(self, target: str) -> tuple[FloatArray, float]:
        """Return which objects of the table the target resembles, (n_objects,) summing to 1, and how much, 0 to 1."""
        cosine = self._vectors.similarities([target], list(self._objects))[0]
        calibrated = self._calibrate(cosine)
        nearest = np.argsort(-calibrated, kind="stable")[: self._neighbours]
        weights = np.zeros_like(calibrated)
        weights[nearest] = calibrated[nearest]
        total = weights.sum()
        if total == 0:
            return weights, 0.0
        return weights / total, float(calibrated.max()) * self._vectors.coverage(target)

    def _calibrate(self, cosine: FloatArray) -> FloatArray:
        return np.clip((cosine - self._floor) / (1.0 - self._floor), 0.0, 1.0)
