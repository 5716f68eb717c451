"""What the scores of a matcher mean: the thresholds that belong to one model."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.types import UNKNOWN_CLASS, FloatArray

_FAINTEST = 1e-6  # confidence that is told from none


@dataclass(frozen=True, slots=True)
class Thresholds:
    """When a score counts. The defaults are those of CLIP ViT-B/32, for which the paper gives m_t = 29."""

    match: float = 29.0
    """m_t: score from which a box is a candidate, m unless `trust` is set, 100 × cosine."""
    landmark: float = 24.0
    """What the best landmark name of an ``unknown`` box must score, 100 × cosine."""
    temperature: float = 1.0
    """T_o of the softmax over landmark names, above 0, 100 × cosine."""
    detection: float = 0.0
    """Confidence below which an ``unknown`` box of the detector is not looked at, 0 to 1."""
    known: float = 0.0
    """Confidence below which a box of a known class is told by matching, 0 to 1."""
    trust: float = 0.0
    """W of the detector's confidence s: a candidate's score is m + W ln s, W ≥ 0, 100 × cosine. Part of a mug looks
    like a mug, too, but the detector knows it for a part."""

    def __post_init__(self) -> None:
        """Check the ranges.

        Raises:
            InputError: A threshold is out of its range.
        """
        for field in fields(self):
            if not math.isfinite(getattr(self, field.name)):
                raise InputError(f"thresholds: {field.name} is {getattr(self, field.name)} (a finite number)")
        if self.trust < 0:
            raise InputError(f"thresholds: trust is {self.trust} (0 or more)")
        if self.temperature <= 0:
            raise InputError(f"thresholds: temperature is {self.temperature} (above 0)")
        for name, share in (("detection", self.detection), ("known", self.known)):
            if not 0.0 <= share < 1.0:
                raise InputError(f"thresholds: {name} is {share} (0 or more, below 1)")

    def candidate_scores(self, matching: FloatArray, confidence: FloatArray) -> FloatArray:
        """Return the scores that are compared with m_t.

        Args:
            matching: (n, m) or (n,) m of n boxes with texts, 100 × cosine.
            confidence: (n,) the detector's, 0 to 1.
        """
        shift = self.trust * np.log(np.maximum(confidence, _FAINTEST))
        return matching + shift.reshape(-1, *[1] * (matching.ndim - 1))

    def is_faint(self, label: str, confidence: float) -> bool:
        """Return whether a detector's box is not looked at."""
        return label == UNKNOWN_CLASS and confidence < self.detection

    def is_unknown(self, label: str, confidence: float) -> bool:
        """Return whether a detector's box is to be told by matching."""
        return label == UNKNOWN_CLASS or confidence < self.known
