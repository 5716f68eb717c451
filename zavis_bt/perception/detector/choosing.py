"""From what the network says of its boxes to detections."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor
from torchvision.ops import batched_nms, box_iou

from zavis_bt.perception.detector.config import Choice
from zavis_bt.perception.detector.mln import aleatoric, epistemic
from zavis_bt.perception.detector.network import DetectorNetwork
from zavis_bt.perception.detector.rois import Regions


@dataclass(frozen=True, slots=True)
class Chosen:
    """Boxes that are detections, best first."""

    boxes: Tensor
    """(n, 4) [px]."""
    labels: Tensor
    """(n,) number of the known class, or that of ``unknown``."""
    scores: Tensor
    """(n,) 0 to 1."""
    probabilities: Tensor
    """(n, K) of the known classes, given that it is one of them."""
    epistemic: Tensor
    aleatoric: Tensor

    def take(self, rows: Tensor) -> Chosen:
        """Return some of them."""
        return Chosen(
            *(each[rows] for each in (self.boxes, self.labels, self.scores)),
            *(each[rows] for each in (self.probabilities, self.epistemic, self.aleatoric)),
        )


def choose(regions: Regions, network: DetectorNetwork, choice: Choice) -> Chosen:
    """Return the detections among one image's boxes."""
    config, mixture = network.config, regions.mixture
    known = len(config.known)
    shares = mixture.mean()
    scores, labels = shares[:, :known].max(dim=1)
    unsure, vague = epistemic(mixture), aleatoric(mixture)
    if config.unknown is not None:
        strange = shares[:, known] > scores
        if network.clusters is not None:
            strange |= network.clusters.is_unknown(mixture)
        else:
            strange |= network.uncertainty.cdf(unsure + vague) > choice.cdf
        thing = 1 - shares[:, -1]
        labels = torch.where(strange, known, labels)
        scores = torch.where(strange, thing * regions.quality**choice.quality_power, scores)
    conditional = shares[:, :known] / shares[:, :known].sum(dim=1, keepdim=True).clamp(min=1e-12)
    everything = Chosen(regions.boxes, labels, scores, conditional, unsure, vague)
    return _thinned(everything, known, choice)


def _thinned(found: Chosen, known: int, choice: Choice) -> Chosen:
    """Keep what is good enough and not said twice; ``known`` is the number of known classes."""
    sides = (found.boxes[:, 2:] - found.boxes[:, :2]).amin(dim=1)
    least = torch.where(found.labels < known, choice.known_score, choice.unknown_score)
    found = found.take(torch.where((found.scores >= least) & (sides >= 1))[0])
    is_known = found.labels < known
    named, strange = found.take(torch.where(is_known)[0]), found.take(torch.where(~is_known)[0])
    named = named.take(batched_nms(named.boxes, named.scores, named.labels, choice.known_nms))
    strange = strange.take(batched_nms(strange.boxes, strange.scores, strange.labels, choice.unknown_nms))
    if len(named.boxes) and len(strange.boxes):
        better = box_iou(strange.boxes, named.boxes) > choice.covered
        better &= named.scores[None] > strange.scores[:, None]
        strange = strange.take(torch.where(~better.any(dim=1))[0])
    joined = _joined(named, strange)
    return joined.take(joined.scores.argsort(descending=True)[: choice.most])


def _joined(a: Chosen, b: Chosen) -> Chosen:
    names = ("boxes", "labels", "scores", "probabilities", "epistemic", "aleatoric")
    return Chosen(*(torch.cat([getattr(a, name), getattr(b, name)]) for name in names))
