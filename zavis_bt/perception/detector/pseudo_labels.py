"""Labels for unknown things, made while training from what is proposed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torchvision.ops import box_iou, nms

from zavis_bt.perception.detector.proposals import Proposals, Target

Objectness = Callable[[NDArray[np.uint8], NDArray[np.floating]], NDArray[np.float32]]
"""o(B) of boxes (n, 4) in an image (h, w, 3), (n,) in 0..1; see `zavis_bt.perception.clip.ClipObjectness`."""

_CANDIDATES, _CANDIDATE_NMS, _LEAST_SIDE, _DOUBT = 12, 0.4, 5.0, 0.5


class Labelling(Protocol):
    """A way to label unknown things."""

    trains_proposals: bool
    """Whether the labels are also the proposal network's."""

    def __call__(self, images: Tensor, proposals: Proposals, targets: list[Target], progress: float) -> None:
        """Add pseudo boxes and ignored regions to targets; ``progress`` is the share of the training behind."""


def pseudo_count(iteration: int, iterations: int) -> int:
    """Return the paper's number of pseudo labels in an image, k = int(3 · iter / max_iter) + 1."""
    return int(3 * iteration / iterations) + 1


class ClipLabelling:
    """The paper's: the k best proposals whose objectness for CLIP is above 0.9.

    Deviations: what else CLIP takes rather for a thing than for background (o over one half) is neither, instead of
    background; labels come after a first tenth of the training, when proposals are boxes; only the best 12 proposals of
    an image that do not overlap are shown to CLIP.
    """

    trains_proposals = True

    def __init__(self, objectness: Objectness, *, threshold: float = 0.9, start: float = 0.1) -> None:
        self._objectness, self._threshold, self._start = objectness, threshold, start

    def __call__(self, images: Tensor, proposals: Proposals, targets: list[Target], progress: float) -> None:
        """Add pseudo boxes, and regions that are neither."""
        if progress < self._start:
            return
        most = pseudo_count(int(progress * 1e6), 10**6)
        pictures = (images.detach() * 255).round().byte().permute(0, 2, 3, 1).cpu().numpy()
        for picture, boxes, scores, target in zip(pictures, proposals.boxes, proposals.scores, targets, strict=True):
            candidates = _elsewhere(boxes, scores, target)
            if not len(candidates):
                continue
            chances = torch.from_numpy(self._objectness(picture, candidates.cpu().numpy()))
            chosen = torch.where(chances > self._threshold)[0][:most]
            perhaps = chances > _DOUBT
            perhaps[chosen] = False
            target.pseudo = candidates[chosen.to(candidates.device)]
            target.ignored = torch.cat([target.ignored, candidates[perhaps.to(candidates.device)]])


class ProposalLabelling:
    """ORE's: the best proposal of an image that is no known thing, for the box head only."""

    trains_proposals = False

    def __init__(self, most: int = 1) -> None:
        self._most = most

    def __call__(self, images: Tensor, proposals: Proposals, targets: list[Target], progress: float) -> None:
        """Add pseudo boxes."""
        for boxes, scores, target in zip(proposals.boxes, proposals.scores, targets, strict=True):
            target.pseudo = _elsewhere(boxes, scores, target)[: self._most]


def _elsewhere(boxes: Tensor, scores: Tensor, target: Target) -> Tensor:
    """Return the best boxes that overlap neither one another nor known things, best first."""
    sides = (boxes[:, 2:] - boxes[:, :2]).amin(dim=1)
    free = sides >= _LEAST_SIDE
    for taken in (target.boxes, target.ignored):
        if len(taken):
            free &= (box_iou(taken, boxes).amax(dim=0) < 0.3) & (_inside(boxes, taken) < 0.7)
    boxes, scores = boxes[free], scores[free]
    return boxes[nms(boxes, scores, _CANDIDATE_NMS)[:_CANDIDATES]]


def _inside(boxes: Tensor, others: Tensor) -> Tensor:
    """Return the share of each box that lies in the other that holds most of it, unless the other is much larger."""
    low = torch.maximum(boxes[:, None, :2], others[None, :, :2])
    high = torch.minimum(boxes[:, None, 2:], others[None, :, 2:])
    areas = (boxes[:, 2:] - boxes[:, :2]).prod(dim=1)[:, None]
    whole = (others[:, 2:] - others[:, :2]).prod(dim=1)[None]
    share = (high - low).clamp(min=0).prod(dim=-1) / areas.clamp(min=1e-6)
    return torch.where(whole < 4 * areas, share, torch.zeros_like(share)).amax(dim=1)
