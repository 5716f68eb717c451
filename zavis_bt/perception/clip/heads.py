"""Classifiers beside the text tower, which help the image tower over the first part of a training."""

from __future__ import annotations

import torch.nn.functional as F
from torch import Tensor, nn

from zavis_bt.perception.clip.captions import NO_COLOUR


class LabelHeads(nn.Module):
    """Linear classifiers of category and colour on the image tower's output."""

    def __init__(self, dimension: int, categories: int, colours: int) -> None:
        super().__init__()
        self.category = nn.Linear(dimension, categories)
        self.colour = nn.Linear(dimension, max(colours, 1))

    def loss(self, vectors: Tensor, categories: Tensor, colours: Tensor) -> Tensor:
        """Return the cross entropies' sum, the colour's at half weight [nat]."""
        return label_loss(self.category(vectors), self.colour(vectors), categories, colours)


def label_loss(of_category: Tensor, of_colour: Tensor, categories: Tensor, colours: Tensor) -> Tensor:
    """Return the cross entropies of logits (n, k) and (n, c), the colour's at half weight; crops may have no colour."""
    loss = F.cross_entropy(of_category, categories)
    if bool((colours != NO_COLOUR).any()):
        loss = loss + 0.5 * F.cross_entropy(of_colour, colours, ignore_index=NO_COLOUR)
    return loss
