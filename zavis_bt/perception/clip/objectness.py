"""How much a box looks like a thing, whichever."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.clip.crops import cut_out
from zavis_bt.perception.clip.model import ClipModel
from zavis_bt.perception.clip.prompts import BACKGROUND_PROMPTS, OBJECT_PROMPTS


class ClipObjectness:
    """The paper's objectness o(B): one minus the share of the three background prompts among the fourteen.

    The share is taken over the softmax of the model's logits. The paper's formula takes it over the cosines
    themselves; those of fourteen prompts are nearly equal, and o(B) would be about 11/14 for every box.
    """

    def __init__(self, model: ClipModel) -> None:
        self._model = model

    def __call__(self, rgb: NDArray[np.uint8], boxes: NDArray[np.floating]) -> NDArray[np.float32]:
        """Return o(B) of each box.

        Args:
            rgb: (h, w, 3).
            boxes: (n, 4) ``x0, y0, x1, y1`` [px].

        Returns:
            (n,) in 0..1.
        """
        cosines = self._model.scores(cut_out(rgb, boxes), (*BACKGROUND_PROMPTS, *OBJECT_PROMPTS)) / 100
        logits = self._model.logit_scale * cosines
        shares = np.exp(logits - logits.max(axis=1, keepdims=True, initial=-np.inf))
        background = shares[:, : len(BACKGROUND_PROMPTS)].sum(axis=1) / shares.sum(axis=1)
        objectness: NDArray[np.float32] = (1 - background).astype(np.float32)
        return objectness
