"""Text-image matching in a frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.clip.crops import cut_out
from zavis_bt.perception.clip.model import ClipModel
from zavis_bt.types import Box, FloatArray, RgbdFrame


class ClipMatcher:
    """The paper's matching score m = f(crop) · g("a photo of [object]"), times 100."""

    def __init__(self, model: ClipModel) -> None:
        self.model = model

    def match(self, frame: RgbdFrame, boxes: Sequence[Box], texts: Sequence[str]) -> FloatArray:
        """Return the scores (n, m) of n boxes with m texts, on the 100 × cosine scale."""
        return self.match_image(frame.rgb, np.asarray(boxes, dtype=np.float64).reshape(-1, 4), texts)

    def match_image(self, rgb: NDArray[np.uint8], boxes: NDArray[np.floating], texts: Sequence[str]) -> FloatArray:
        """Return the same for an image (h, w, 3) and boxes (n, 4) [px]."""
        return self.model.scores(cut_out(rgb, boxes), texts).astype(np.float64)
