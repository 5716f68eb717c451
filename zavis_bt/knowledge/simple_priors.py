"""Priors without commonsense: the paper's word-similarity ablation, and no knowledge at all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from zavis_bt.knowledge.vectors import WordVectors
from zavis_bt.types import FloatArray


class WordPrior:
    """p(target | landmark) = cosine of the two names' word vectors, clipped to [0, 1]."""

    def __init__(self, vectors: WordVectors) -> None:
        self._vectors = vectors

    def probability(self, target: str, landmarks: Sequence[str]) -> FloatArray:
        """Return p(target | landmark) in [0, 1], shape (n_landmarks,)."""
        cosines: FloatArray = self._vectors.similarities([target], landmarks)[0]
        return np.clip(cosines, 0.0, 1.0)


class UniformPrior:
    """p(target | landmark) = 1 everywhere.

    The cost of every landmark gets the same λ1 · 1e-3, so that distance and uncertainty alone decide, and the
    threshold t_c skips none.
    """

    def probability(self, target: str, landmarks: Sequence[str]) -> FloatArray:
        """Return ones, shape (n_landmarks,)."""
        return np.ones(len(landmarks))
