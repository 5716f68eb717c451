"""Class, box and localisation quality of each proposal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F
from torchvision.models.detection._utils import BoxCoder
from torchvision.ops import box_iou, clip_boxes_to_image

from zavis_bt.perception.detector.backbones import Parts
from zavis_bt.perception.detector.config import DetectorConfig
from zavis_bt.perception.detector.mln import Mixture, MixtureHead, mace_loss
from zavis_bt.perception.detector.proposals import Target

SAMPLES, _POSITIVE = 64, 0.4  # boxes of an image that are learnt from, and how many of them may be things


class Regions(NamedTuple):
    """What the network says of n boxes."""

    boxes: Tensor
    """(n, 4) refined, inside the image [px]."""
    mixture: Mixture
    quality: Tensor
    """(n,) expected IoU of the box with the thing, 0 to 1."""
    features: Tensor
    """(n, f)."""


@dataclass(frozen=True, slots=True)
class Sample:
    """Boxes of one image to learn from."""

    boxes: Tensor
    labels: Tensor
    truth: Tensor
    """(n, 4) the box of the thing that is meant; anything for background."""
    overlap: Tensor
    """(n,) IoU with it."""


@dataclass(frozen=True, slots=True)
class Learnt:
    """Losses, and what other losses are made of."""

    losses: dict[str, Tensor]
    mixture: Mixture
    features: Tensor
    labels: Tensor


class RoiNetwork(nn.Module):
    """Box head with a mixture of logits, class-agnostic boxes and localisation quality."""

    def __init__(self, config: DetectorConfig, parts: Parts) -> None:
        super().__init__()
        self.pool, self.head = parts.pool, parts.head
        self.classes = MixtureHead(parts.features, config.labels, config.components)
        self.boxes = nn.Linear(parts.features, 4)
        self.quality = nn.Linear(parts.features, 1)
        self.samples = SAMPLES
        self._coder = BoxCoder((10.0, 10.0, 5.0, 5.0))
        self._known, self._unknown, self._background = len(config.known), config.unknown, config.labels - 1

    def forward(self, features: dict[str, Tensor], boxes: list[Tensor], sizes: list[tuple[int, int]]) -> list[Regions]:
        """Return what each image's boxes show."""
        mixture, deltas, quality, vectors = self._read(features, boxes, sizes)
        counts = [len(each) for each in boxes]
        found = []
        for k, rows in enumerate(torch.arange(sum(counts), device=deltas.device).split(counts)):
            refined = self._coder.decode_single(deltas[rows], boxes[k]).view(-1, 4)
            refined = clip_boxes_to_image(refined, sizes[k])
            part = Mixture(mixture.logits[rows], mixture.log_weights[rows])
            found.append(Regions(refined, part, quality[rows].sigmoid(), vectors[rows]))
        return found

    def learn(
        self, features: dict[str, Tensor], proposals: list[Tensor], targets: list[Target], sizes: list[tuple[int, int]]
    ) -> Learnt:
        """Return the losses on boxes sampled from the proposals and the things themselves."""
        pairs = zip(proposals, targets, strict=True)
        samples = [sample(boxes, target, self._unknown, self._background, self.samples) for boxes, target in pairs]
        boxes = [each.boxes for each in samples]
        mixture, deltas, quality, vectors = self._read(features, boxes, sizes)
        labels, truth = (torch.cat([getattr(each, name) for each in samples]) for name in ("labels", "truth"))
        flat = torch.cat(boxes)
        exact = torch.where(
            (labels != self._background) & (labels != (-1 if self._unknown is None else self._unknown))
        )[0]
        wanted = self._coder.encode_single(truth[exact], flat[exact])
        losses = {
            "classes": mace_loss(mixture, labels),
            "boxes": F.smooth_l1_loss(deltas[exact], wanted, beta=1.0, reduction="sum") / max(len(labels), 1),
            "quality": self._quality_loss(samples, flat, deltas.detach(), quality),
        }
        return Learnt(losses, mixture, vectors, labels)

    def _read(
        self, features: dict[str, Tensor], boxes: list[Tensor], sizes: list[tuple[int, int]]
    ) -> tuple[Mixture, Tensor, Tensor, Tensor]:
        vectors = self.head(self.pool(features, boxes, sizes))
        return self.classes(vectors), self.boxes(vectors), self.quality(vectors).squeeze(1), vectors

    def _quality_loss(self, samples: list[Sample], boxes: Tensor, deltas: Tensor, quality: Tensor) -> Tensor:
        """Compare with the refined boxes' IoU, near known things only: how well a box fits is no matter of class."""
        overlap, truth = (torch.cat([getattr(each, name) for each in samples]) for name in ("overlap", "truth"))
        near = torch.where(overlap > 0.3)[0]
        if not len(near):
            return quality.sum() * 0
        refined = self._coder.decode_single(deltas[near], boxes[near]).view(-1, 4)
        return F.binary_cross_entropy_with_logits(quality[near], _paired_iou(refined, truth[near]))


def sample(proposals: Tensor, target: Target, unknown: int | None, background: int, most: int = SAMPLES) -> Sample:
    """Choose boxes of an image to learn from: things where the IoU is over one half, else background.

    Boxes on ignored regions are left out. Boxes of pseudo labels are ``unknown`` unless a known thing is there.
    """
    boxes = torch.cat([proposals, target.boxes, target.pseudo])
    truth, overlap, match = boxes.clone(), boxes.new_zeros(len(boxes)), torch.zeros(len(boxes), dtype=torch.long)
    labels = torch.full((len(boxes),), background, device=boxes.device)
    if len(target.boxes):
        overlap, match = box_iou(target.boxes, boxes).max(dim=0)
        truth = target.boxes[match]
        labels[overlap > 0.5] = target.labels[match[overlap > 0.5]]
    usable = torch.ones(len(boxes), dtype=torch.bool, device=boxes.device)
    free = labels == background
    if len(target.pseudo) and unknown is not None:
        pseudo = box_iou(target.pseudo, boxes).amax(dim=0)
        labels[free & (pseudo > 0.5)] = unknown
        usable[free & (pseudo > 0.3) & (pseudo <= 0.5)] = False
    if len(target.ignored):
        usable[(labels == background) & (box_iou(target.ignored, boxes).amax(dim=0) > 0.3)] = False
    thing = labels != background
    positive = _some(torch.where(usable & thing)[0], int(most * _POSITIVE))
    rest = _some(torch.where(usable & ~thing)[0], most - len(positive))
    rows = torch.cat([positive, rest])
    return Sample(boxes[rows], labels[rows], truth[rows], overlap[rows])


def _some(rows: Tensor, most: int) -> Tensor:
    return rows[torch.randperm(len(rows), device=rows.device)[:most]]


def _paired_iou(a: Tensor, b: Tensor) -> Tensor:
    """Return the IoU of each row of one with the same row of the other."""
    low, high = torch.maximum(a[:, :2], b[:, :2]), torch.minimum(a[:, 2:], b[:, 2:])
    common = (high - low).clamp(min=0).prod(dim=1)
    areas = (a[:, 2:] - a[:, :2]).prod(dim=1) + (b[:, 2:] - b[:, :2]).prod(dim=1)
    return common / (areas - common).clamp(min=1e-6)
