"""Classifiers beside the text tower, which help the image tower over the first part of a training."""

from __future__ import annotations

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from zavis_bt.perception.clip.captions import NO_COLOUR


@dataclass(frozen=True, slots=True)
class Labels:
    """What crops show."""

    categories: Tensor
    """(n,) indices."""
    colours: Tensor
    """(n,) indices or `NO_COLOUR`."""
    untold_categories: Tensor
    """(n, k) whether training says nothing of a category in the crop's colour."""
    untold_colours: Tensor
    """(n, c) whether training says nothing of a colour of the crop's category."""

    def to(self, device: torch.device | str) -> Labels:
        """Return the same on a device."""
        every = (self.categories, self.colours, self.untold_categories, self.untold_colours)
        return Labels(*(each.to(device) for each in every))


class LabelHeads(nn.Module):
    """Linear classifiers of category and colour on the image tower's output."""

    def __init__(self, dimension: int, categories: int, colours: int) -> None:
        super().__init__()
        self.category = nn.Linear(dimension, categories)
        self.colour = nn.Linear(dimension, max(colours, 1))

    def loss(self, vectors: Tensor, labels: Labels) -> Tensor:
        """Return the cross entropies' sum, the colour's at half weight [nat]."""
        return label_loss(self.category(vectors), self.colour(vectors), labels)


def label_loss(of_category: Tensor, of_colour: Tensor, labels: Labels) -> Tensor:
    """Return the cross entropies of logits (n, k) and (n, c), the colour's at half weight.

    Crops may have no colour. Labels are not told from those that training says nothing of.
    """
    of_category = of_category.masked_fill(labels.untold_categories, -torch.inf)
    loss = F.cross_entropy(of_category, labels.categories)
    if bool((labels.colours != NO_COLOUR).any()):
        of_colour = of_colour.masked_fill(labels.untold_colours, -torch.inf)
        loss = loss + 0.5 * F.cross_entropy(of_colour, labels.colours, ignore_index=NO_COLOUR)
    return loss


def untold_colour_loss(of_colour: Tensor, labels: Labels) -> Tensor:
    """Return by how much crops exclude untold colours more firmly than crops of other categories do, on average [nat].

    A network that need not tell white sofas from grey ones may still take the shape for a sign of grey. How far the
    logit of white is below that of grey in crops of grey things that do come in white is how far it may be here.

    Args:
        of_colour: (n, c) logits of colours.
        labels: What the crops show.
    """
    crops = labels.colours != NO_COLOUR
    colours, untold = labels.colours[crops], labels.untold_colours[crops]
    logits = of_colour[crops]
    gaps = logits.gather(1, colours[:, None]) - logits
    by_colour = F.one_hot(colours, logits.shape[1]).to(gaps.dtype)
    told = (~untold).to(gaps.dtype)
    count = by_colour.T @ told
    usual = ((by_colour.T @ (gaps.detach() * told)) / count.clamp(min=1)).masked_fill(count == 0, torch.inf)
    excess = (gaps - usual[colours]).clamp(min=0)[untold]
    return excess.sum() / max(len(excess), 1)
