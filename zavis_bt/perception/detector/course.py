"""What is learnt when: collages first, then views of whole images with some collages among them."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from zavis_bt.perception.detector.batches import Batches
from zavis_bt.perception.detector.collages import Collages
from zavis_bt.perception.detector.proposals import Target


class Course(torch.utils.data.Dataset[tuple[Tensor, list[Target], bool]]):
    """Batch k of a training, which is a function of the seed and k alone, and whether it is of collages."""

    def __init__(self, views: Batches, collages: Collages | None, *, first: int, share: float, seed: int) -> None:
        """Join both.

        Args:
            views: Of whole images.
            collages: Of known things; None for none.
            first: So many batches at the start are collages only.
            share: Of collages after that.
            seed: Of which batches they are.
        """
        self._views, self._first, self._share, self._seed = views, first, share, seed
        self._collages = collages if collages is not None and len(collages) else None

    def __len__(self) -> int:
        return len(self._views)

    def __getitem__(self, number: int) -> tuple[Tensor, list[Target], bool]:
        """Return images (n, 3, h, w) from 0 to 1, what they show, and whether they are collages."""
        if self._collages is not None and (number < self._first or self._is_drawn(number)):
            return *self._collages[number], True
        return *self._views[number], False

    def _is_drawn(self, number: int) -> bool:
        return bool(np.random.default_rng([self._seed, 5, number]).random() < self._share)
