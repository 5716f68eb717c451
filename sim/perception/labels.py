"""The simulated detector's head: class, class probabilities and uncertainties of a box."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sim.frame import InstanceView
from sim.perception.curves import DetectorSettings
from sim.perception.draws import Draws, key_of, keys_of
from sim.perception.words import normal_name
from zavis_bt.types import UNKNOWN_CLASS, Box, Detection, FloatArray, entropy

_MARGIN = (1.5, 3.0)  # logit of the true class above the others: at no chance of detection, added at a sure one
_INSTANCE_SPREAD, _VIEW_SPREAD = 0.6, 0.8  # of the class logits


class Classifier:
    """Labels detected boxes."""

    def __init__(self, known: Sequence[str], draws: Draws, settings: DetectorSettings) -> None:
        self._known, self._keys = list(known), keys_of(list(known))
        self._draws, self._settings = draws, settings

    def __call__(
        self, instance: InstanceView | None, box: Box, score: float, chance: float, key: int, moment: int
    ) -> Detection:
        """Return the detection of a box.

        Args:
            instance: What the box shows; None for a false positive.
            box: The box.
            score: Its confidence.
            chance: How easy it was to detect, 0 to 1.
            key: Key of the instance or of the false positive.
            moment: Key of the frame.
        """
        taken_for = self._taken_for(instance, key, moment)
        if taken_for is None:
            return self._unknown(box, score, key, moment)
        probabilities = self._probabilities(taken_for, chance, key, moment)
        best = int(np.argmax(probabilities))
        luck = self._draws.normal("uncertainty", key, moment, np.arange(2, dtype=np.uint64))
        epistemic = 0.02 * math.exp(0.6 * luck[0]) * (1.5 - chance)
        aleatoric = max(entropy(probabilities) + 0.15 + 0.05 * float(luck[1]), 0.0)
        pairs = tuple(zip(self._known, probabilities.tolist(), strict=True))
        return Detection(box, self._known[best], score, pairs, epistemic, aleatoric)

    def _taken_for(self, instance: InstanceView | None, key: int, moment: int) -> str | None:
        """Return the known class that the head sees in the box, or None for ``unknown``."""
        if not self._known:
            return None
        luck = float(self._draws.uniform("open set", key, moment)[0])
        category = normal_name(instance.category) if instance else ""
        is_furniture = instance is not None and instance.is_furniture
        if is_furniture and category in self._known:
            return None if luck < self._settings.known_as_unknown else category
        rate = self._settings.unknown_as_known if is_furniture else self._settings.unknown_as_known / 3
        return self._lookalike(category, key) if luck < rate else None

    def _lookalike(self, category: str, key: int) -> str:
        """Return a known class for something unknown, rather one that shares a word with it."""
        words = set(category.split())
        weights = np.array([1.0 + 9.0 * len(words & set(name.split())) for name in self._known])
        place = float(self._draws.uniform("lookalike", key)[0]) * weights.sum()
        return self._known[int(np.searchsorted(np.cumsum(weights), place, side="right"))]

    def _probabilities(self, true: str, chance: float, key: int, moment: int) -> FloatArray:
        """Return class probabilities (K,) of a box that shows a known class."""
        logits = _INSTANCE_SPREAD * self._draws.normal("logit", key, self._keys)
        logits += _VIEW_SPREAD * self._draws.normal("logit", key, self._keys, moment)
        logits += np.where(self._keys == np.uint64(key_of(true)), _MARGIN[0] + _MARGIN[1] * chance, 0.0)
        raised = np.exp(logits - logits.max())
        return np.asarray(raised / raised.sum())

    def _unknown(self, box: Box, score: float, key: int, moment: int) -> Detection:
        """Return an ``unknown`` box: mixtures that disagree, probabilities that are spread out."""
        luck = self._draws.uniform("uncertainty", key, moment, np.arange(2, dtype=np.uint64))
        aleatoric = math.log(len(self._known) + 2) * (0.45 + 0.45 * float(luck[0]))  # K + 2 classes, Eq. alea
        return Detection(box, UNKNOWN_CLASS, score, (), 0.1 + 0.3 * float(luck[1]), aleatoric)
