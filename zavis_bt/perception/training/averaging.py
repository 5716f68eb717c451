"""The mean of models that trained on from the same weights.

It is mostly right more often than any of them (Wortsman et al., "Model soups", ICML 2022), and keeps what an earlier
one knew (Wortsman et al., "Robust fine-tuning of zero-shot models", CVPR 2022). The mean of models that grew up apart
knows nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import torch
from torch import Tensor

from zavis_bt.errors import InputError


def averaged_weights(models: Sequence[Mapping[str, Tensor]]) -> dict[str, Tensor]:
    """Return the mean of weights by name; whole numbers are those of the last model.

    Raises:
        InputError: Fewer than two are given, or they are of different architectures.
    """
    if len(models) < 2:
        raise InputError("average: one model is its own mean (name two or more)")
    *others, last = models
    if any(_shapes(other) != _shapes(last) for other in others):
        raise InputError(
            "average: the models' architectures differ (name models that trained on from the same weights)"
        )
    return {
        name: torch.stack([model[name].float() for model in models]).mean(dim=0).to(value.dtype)
        if value.is_floating_point()
        else value
        for name, value in last.items()
    }


def _shapes(weights: Mapping[str, Tensor]) -> dict[str, torch.Size]:
    return {name: value.shape for name, value in weights.items()}
