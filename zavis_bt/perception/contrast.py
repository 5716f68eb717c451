"""Matching scores relative to those of other texts.

The cosine of a crop and a text says less than how it compares with other texts' cosines: a small model likes some
crops with every text, and some texts with every crop. CLIP is trained to tell texts apart, not to rate one alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.protocols import Matcher
from zavis_bt.types import Box, FloatArray, RgbdFrame


@dataclass(frozen=True, slots=True)
class Contrast:
    """What scores are relative to."""

    texts: tuple[str, ...]
    """Names of what boxes may show, whatever is looked for; at least one."""
    temperature: float
    """T of the softmax over these texts, above 0, 100 × cosine: 100 over the model's logit scale."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises:
            InputError: There is no text, or the temperature is out of its range.
        """
        if not self.texts:
            raise InputError("contrast: there are no texts (at least one name of what boxes may show)")
        if not (math.isfinite(self.temperature) and self.temperature > 0):
            raise InputError(f"contrast: temperature is {self.temperature} (above 0)")

    def apply(self, scores: FloatArray, references: FloatArray) -> FloatArray:
        """Return m − T log Σ_r exp(m_r / T), which for a text among `texts` is T times its softmax's logarithm.

        Args:
            scores: (n, m) of n boxes with m texts.
            references: (n, r) of the boxes with `texts`.
        """
        best = references.max(axis=1, keepdims=True)
        total = np.exp((references - best) / self.temperature).sum(axis=1, keepdims=True)
        return np.asarray(scores - best - self.temperature * np.log(total))


class ContrastMatcher:
    """A matcher whose scores are relative to those of other texts; they lie below 0, near 0 for a clear match."""

    def __init__(self, matcher: Matcher, contrast: Contrast) -> None:
        """Wrap a matcher.

        Args:
            matcher: Gives the scores.
            contrast: What they are compared with.
        """
        self._matcher, self._contrast = matcher, contrast

    def match(self, frame: RgbdFrame, boxes: Sequence[Box], texts: Sequence[str]) -> FloatArray:
        """Return scores (n, m) of n boxes with m texts, 100 × cosine relative to the contrast's texts."""
        if not boxes:
            return np.zeros((0, len(texts)))
        both = np.asarray(self._matcher.match(frame, boxes, [*texts, *self._contrast.texts]), dtype=np.float64)
        return self._contrast.apply(both[:, : len(texts)], both[:, len(texts) :])
