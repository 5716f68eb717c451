"""What open-world detection (ORE, Joseph et al. 2021) adds: contrastive clusters of features, and energies."""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from zavis_bt.perception.detector.config import DetectorConfig
from zavis_bt.perception.detector.gaussian import Gaussian
from zavis_bt.perception.detector.mln import Mixture

_MARGIN, _MOMENTUM, _WARM_UP = 10.0, 0.99, 200


def free_energy(mixture: Mixture, known: int) -> Tensor:
    """Return the Helmholtz free energy over the known classes' logits at temperature 1, (n,)."""
    return -mixture.logits[:, 0, :known].logsumexp(dim=-1)


class Clusters(nn.Module):
    """A prototype for each known class and ``unknown``, and the energies of known and unknown boxes.

    ORE fits Weibull distributions to the energies; these are Gaussians, which need no solver.
    """

    prototypes: Tensor
    seen: Tensor
    steps: Tensor

    def __init__(self, config: DetectorConfig, features: int) -> None:
        super().__init__()
        self._known = len(config.known)
        self.register_buffer("prototypes", torch.zeros(self._known + 1, features))
        self.register_buffer("seen", torch.zeros(self._known + 1))
        self.register_buffer("steps", torch.zeros(()))
        self.known_energy, self.unknown_energy = Gaussian(), Gaussian()
        self.frozen = False

    def loss(self, features: Tensor, labels: Tensor) -> Tensor:
        """Return the mean hinge loss of distances to prototypes; moves the prototypes.

        Near its own class's prototype is good, nearer to another's than the margin is not.
        """
        things = labels <= self._known
        features, labels = features[things], labels[things]
        if not self.frozen:
            self._move(features.detach(), labels)
        if self.steps < _WARM_UP or not len(labels):
            return features.sum() * 0
        distances = torch.cdist(features, self.prototypes)
        own = F.one_hot(labels, self._known + 1).bool()
        hinge = torch.where(own, distances, (_MARGIN - distances).clamp(min=0))
        return hinge[:, self.seen > 0].mean()

    def _move(self, features: Tensor, labels: Tensor) -> None:
        self.steps += 1
        for label in labels.unique():
            mean = features[labels == label].mean(dim=0)
            keep = _MOMENTUM if self.seen[label] else 0.0
            self.prototypes[label] = keep * self.prototypes[label] + (1 - keep) * mean
            self.seen[label] += 1

    def is_unknown(self, mixture: Mixture) -> Tensor:
        """Return which boxes' energies are likelier those of unknown things, (n,) bool."""
        energy = free_energy(mixture, self._known)
        if not self.known_energy.count or not self.unknown_energy.count:
            return torch.zeros_like(energy, dtype=torch.bool)
        return self.unknown_energy.log_density(energy) > self.known_energy.log_density(energy)
