"""Mixture of logit networks: a classification head that knows what it does not know."""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F


class Mixture(NamedTuple):
    """J opinions on the class of each of n boxes."""

    logits: Tensor
    """(n, J, labels)."""
    log_weights: Tensor
    """(n, J) logarithms of π, which sum to one."""

    @property
    def weights(self) -> Tensor:
        """Π, (n, J)."""
        return self.log_weights.exp()

    @property
    def probabilities(self) -> Tensor:
        """Of the labels under each mixture, μ of the uncertainties' equations, (n, J, labels)."""
        return self.logits.softmax(dim=-1)

    def mean(self) -> Tensor:
        """Return the mixed probabilities of the labels, (n, labels)."""
        return (self.weights.unsqueeze(-1) * self.probabilities).sum(dim=1)


class MixtureHead(nn.Module):
    """Linear layers from a box's features to its mixture."""

    def __init__(self, features: int, labels: int, components: int) -> None:
        super().__init__()
        self.logits = nn.Linear(features, components * labels)
        self.weights = nn.Linear(features, components)
        self._shape = (components, labels)

    def forward(self, features: Tensor) -> Mixture:
        """Return the mixture of (n, features) boxes."""
        return Mixture(self.logits(features).unflatten(1, self._shape), self.weights(features).log_softmax(dim=1))


def mace_loss(mixture: Mixture, labels: Tensor) -> Tensor:
    """Return the mean over boxes of the cross entropies weighted by π, Eq. MACE.

    Args:
        mixture: Of n boxes.
        labels: (n,) the true ones.
    """
    n, components, _ = mixture.logits.shape
    truth = labels[:, None].expand(n, components)
    entropies = F.cross_entropy(mixture.logits.flatten(0, 1), truth.flatten(), reduction="none")
    return (mixture.weights * entropies.view(n, components)).sum(dim=1).mean()


def epistemic(mixture: Mixture) -> Tensor:
    """Return how much the mixtures disagree, σ_e² of Eq. epis, (n,)."""
    mu, pi = mixture.probabilities, mixture.weights
    mean = (pi.unsqueeze(-1) * mu).sum(dim=1, keepdim=True)
    return (pi * (mu - mean).square().sum(dim=-1)).sum(dim=1)


def aleatoric(mixture: Mixture) -> Tensor:
    """Return the mixtures' mean entropy, σ_a² of Eq. alea [nat], (n,)."""
    mu, pi = mixture.probabilities, mixture.weights
    entropies: Tensor = torch.special.entr(mu).sum(dim=-1)
    return (pi * entropies).sum(dim=1)


def total_uncertainty(mixture: Mixture) -> Tensor:
    """Return the sum of both uncertainties, (n,)."""
    return epistemic(mixture) + aleatoric(mixture)
