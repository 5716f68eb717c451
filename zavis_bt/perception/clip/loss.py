"""Contrastive loss between crops and captions."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor


def contrastive_loss(images: Tensor, texts: Tensor, true: Tensor, possible: Tensor, scale: Tensor) -> Tensor:
    """Return InfoNCE of crops and captions of which several may be true of one another.

    A crop's own caption is told from the captions that are not true of it, and a caption's crops, each for itself,
    from those it is not true of: a second red wallet in the batch is no mistake for "red wallet", nor is "furniture"
    one for a sofa.

    Args:
        images: (n, d) unit length.
        texts: (m, d) unit length, m ≥ n; the i-th is the caption of crop i, those beyond are of none.
        true: (n, m) whether a caption is true of a crop.
        possible: (n, m) whether it is or may be: these are not told from a crop's own.
        scale: Factor of the cosines, e to the model's ``logit_scale``.

    Returns:
        The mean loss [nat].
    """
    n = len(images)
    logits = scale * images @ texts.T
    own = torch.eye(n, len(texts), dtype=torch.bool, device=logits.device)
    of_images = logits.masked_fill(possible & ~own, -torch.inf)
    labels = torch.arange(n, device=logits.device)
    image_loss = F.cross_entropy(of_images, labels)
    # log of each true crop's share, had it been the only true one beside the wrong ones
    wrong = logits.masked_fill(possible, -torch.inf).logsumexp(dim=0)[None, :n]
    right, said = logits[:, :n], true[:, :n].to(logits.dtype)
    text_losses = (torch.logaddexp(right, wrong) - right) * said
    text_loss = (text_losses.sum(dim=0) / said.sum(dim=0).clamp(min=1)).mean()
    return (image_loss + text_loss) / 2
