"""After the training: the distributions by which unknown things are told."""

from __future__ import annotations

from collections.abc import Iterable

import torch
from torch import Tensor

from zavis_bt.perception.detector.clustering import free_energy
from zavis_bt.perception.detector.mln import total_uncertainty
from zavis_bt.perception.detector.network import DetectorNetwork
from zavis_bt.perception.detector.proposals import Target
from zavis_bt.perception.detector.pseudo_labels import Labelling


@torch.no_grad()
def fit(
    network: DetectorNetwork, batches: Iterable[tuple[Tensor, list[Target]]], labelling: Labelling | None = None
) -> None:
    """Fit what the method needs to boxes of the training set.

    The paper's method: a Gaussian to the total uncertainty of boxes on known things. ORE: one to the free energy of
    those, and one to that of boxes that the labelling takes for unknown things.
    """
    network.eval()
    known, clusters = len(network.config.known), network.clusters
    network.uncertainty.reset()
    if clusters is not None:
        clusters.known_energy.reset()
        clusters.unknown_energy.reset()
        clusters.frozen = True
    for images, targets in batches:
        learnt = network.learn(images, targets, labelling, progress=1 - 1e-6)
        named = learnt.labels < known
        network.uncertainty.add(total_uncertainty(learnt.mixture)[named])
        if clusters is not None:
            energy = free_energy(learnt.mixture, known)
            clusters.known_energy.add(energy[named])
            clusters.unknown_energy.add(energy[learnt.labels == known])
    if clusters is not None:
        clusters.frozen = False
    network.train()
