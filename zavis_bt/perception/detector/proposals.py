"""Region proposals that need not take every unlabelled region for background."""

from __future__ import annotations

from dataclasses import dataclass, field

import torch
from torch import Tensor, nn
from torch.nn import functional as F
from torchvision.models.detection.anchor_utils import AnchorGenerator
from torchvision.models.detection.image_list import ImageList
from torchvision.models.detection.rpn import RegionProposalNetwork, RPNHead, concat_box_prediction_layers
from torchvision.ops import box_iou


@dataclass(slots=True)
class Target:
    """What one image of a batch shows, in its pixels."""

    boxes: Tensor
    """(n, 4)."""
    labels: Tensor
    """(n,)."""
    ignored: Tensor
    """(m, 4) regions that are neither things nor background."""
    pseudo: Tensor = field(default_factory=lambda: torch.zeros(0, 4))
    """(k, 4) boxes that are thought to be unknown things."""

    def to(self, device: str | torch.device) -> Target:
        """Return the same on a device."""
        return Target(*(each.to(device) for each in (self.boxes, self.labels, self.ignored, self.pseudo)))


@dataclass(frozen=True, slots=True)
class Proposals:
    """What the network proposes, and what its loss needs."""

    boxes: list[Tensor]
    """Of each image (n, 4), best first."""
    scores: list[Tensor]
    """Of each image (n,), 0 to 1."""
    anchors: list[Tensor]
    objectness: Tensor
    deltas: Tensor


class ProposalNetwork(RegionProposalNetwork):  # type: ignore[misc]  # torchvision ships no types
    """Torchvision's region proposal network in two halves, so that labels may come from its proposals."""

    def __init__(self, channels: int, anchors: AnchorGenerator, *, test_top_n: int) -> None:
        head = RPNHead(channels, anchors.num_anchors_per_location()[0])
        top_n = {"training": 400, "testing": 300}
        kept = {"training": 200, "testing": test_top_n}
        super().__init__(anchors, head, 0.6, 0.3, 128, 0.5, top_n, kept, nms_thresh=0.7)

    def propose(self, images: Tensor, sizes: list[tuple[int, int]], features: dict[str, Tensor]) -> Proposals:
        """Return the proposals of a batch.

        Args:
            images: (n, 3, h, w).
            sizes: Height and width of each image without padding.
            features: Maps of the images.
        """
        maps = list(features.values())
        objectness, deltas = self.head(maps)
        anchors = self.anchor_generator(ImageList(images, sizes), maps)
        counts = [level[0].numel() for level in objectness]
        flat, flat_deltas = concat_box_prediction_layers(objectness, deltas)
        boxes = self.box_coder.decode(flat_deltas.detach(), anchors).view(len(anchors), -1, 4)
        kept, scores = self.filter_proposals(boxes, flat, sizes, counts)
        return Proposals(kept, scores, anchors, flat, flat_deltas)

    def losses(self, proposals: Proposals, targets: list[Target]) -> dict[str, Tensor]:
        """Return the losses of objectness and boxes; pseudo boxes count for objectness only."""
        known = [{"boxes": target.boxes} for target in targets]
        labels, matched = self.assign_targets_to_anchors(proposals.anchors, known)
        real = [each == 1 for each in labels]
        for each, anchors, target in zip(labels, proposals.anchors, targets, strict=True):
            relabel(each, anchors, target)
        regression = self.box_coder.encode(matched, proposals.anchors)
        positive, negative = (torch.cat(each).bool() for each in self.fg_bg_sampler(labels))
        sampled = torch.where(positive | negative)[0]
        objectness = F.binary_cross_entropy_with_logits(
            proposals.objectness.flatten()[sampled], torch.cat(labels)[sampled]
        )
        exact = positive & torch.cat(real)
        error = F.smooth_l1_loss(proposals.deltas[exact], torch.cat(regression)[exact], beta=1 / 9, reduction="sum")
        return {"rpn_objectness": objectness, "rpn_boxes": error / max(len(sampled), 1)}


def relabel(labels: Tensor, anchors: Tensor, target: Target) -> None:
    """Let anchors on ignored regions be neither, and those on pseudo boxes things."""
    if len(target.ignored):
        labels[(labels == 0) & (box_iou(target.ignored, anchors).amax(dim=0) > 0.3)] = -1
    if len(target.pseudo):
        overlap = box_iou(target.pseudo, anchors)
        best = overlap.amax(dim=0)
        labels[(labels < 1) & (best > 0.3)] = -1
        labels[(labels < 1) & (best > 0.6)] = 1
        labels[overlap.argmax(dim=1)] = 1


def initialise(module: nn.Module) -> None:
    """Begin with objectness near the share of anchors that are things, which spares the first iterations."""
    assert isinstance(module, ProposalNetwork)
    nn.init.constant_(module.head.cls_logits.bias, -3.0)
