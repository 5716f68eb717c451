"""The detector's network: backbone, proposals, boxes; what the methods learn besides."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace

import torch
from torch import Tensor, nn

from zavis_bt.perception.detector.backbones import build_parts
from zavis_bt.perception.detector.clustering import Clusters
from zavis_bt.perception.detector.config import DetectorConfig
from zavis_bt.perception.detector.gaussian import Gaussian
from zavis_bt.perception.detector.proposals import ProposalNetwork, Target, initialise
from zavis_bt.perception.detector.pseudo_labels import Labelling
from zavis_bt.perception.detector.rois import Learnt, Regions, RoiNetwork
from zavis_bt.perception.training.precision import mixed_precision

_MEAN, _STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)  # of ImageNet, as torchvision's weights want it
_TEST_PROPOSALS = {"tiny": 120, "resnet50_fpn": 300, "resnet50_c4": 300}


class DetectorNetwork(nn.Module):
    """A two-stage detector. Images are (n, 3, h, w) float32 from 0 to 1, all of one size."""

    mean: Tensor
    std: Tensor

    def __init__(self, config: DetectorConfig, backbone_weights: dict[str, Tensor] | None = None) -> None:
        super().__init__()
        self.config = config
        parts = build_parts(config.backbone, backbone_weights)
        self.body = parts.body
        self.proposals = ProposalNetwork(parts.channels, parts.anchors, test_top_n=_TEST_PROPOSALS[config.backbone])
        self.rois = RoiNetwork(config, parts)
        initialise(self.proposals)
        self.uncertainty = Gaussian()
        self.clusters = Clusters(config, parts.features) if config.method == "ore" else None
        for name, values in (("mean", _MEAN), ("std", _STD)):
            self.register_buffer(name, torch.tensor(values).view(1, 3, 1, 1), persistent=False)

    def forward(self, images: Tensor) -> list[Regions]:
        """Return all boxes that are proposed, with what the network says of them."""
        features, sizes = self.features(images)
        proposals = self.proposals.propose(images, sizes, features)
        found: list[Regions] = self.rois(features, proposals.boxes, sizes)
        return found

    def train(self, mode: bool = True) -> DetectorNetwork:
        """Switch to training, or from it; statistics that are frozen stay."""
        super().train(mode)
        if self.config.frozen:
            for each in self.modules():
                if isinstance(each, nn.BatchNorm2d):
                    each.eval()
        return self

    def learn(
        self, images: Tensor, targets: list[Target], labelling: Labelling | None = None, progress: float = 0.0
    ) -> Learnt:
        """Return the losses of a batch, and what its boxes look like.

        Args:
            images: The batch.
            targets: Known things; unknown ones are added.
            labelling: Where labels of unknown things come from.
            progress: Share of the training that is behind.
        """
        features, sizes = self.features(images)
        proposals = self.proposals.propose(images, sizes, features)
        if labelling is not None and labelling.trains_proposals:
            labelling(images, proposals, targets, progress)
        losses = self.proposals.losses(proposals, targets)
        if labelling is not None and not labelling.trains_proposals:
            labelling(images, proposals, targets, progress)
        learnt = self.rois.learn(features, proposals.boxes, targets, sizes)
        losses |= learnt.losses
        if self.clusters is not None:
            losses["clusters"] = self.clusters.loss(learnt.features, learnt.labels)
        return replace(learnt, losses=losses)

    def normalised(self, images: Tensor) -> Tensor:
        """Return images as the backbone reads them."""
        return (images - self.mean) / self.std

    def features(self, images: Tensor) -> tuple[dict[str, Tensor], list[tuple[int, int]]]:
        """Return the backbone's maps, and height and width of each image."""
        with mixed_precision(images.device.type) if self.training else nullcontext():
            maps = self.body(self.normalised(images))
        features = {name: each.float() for name, each in maps.items()}  # boxes are too fine for sixteen bits
        return features, [(images.shape[2], images.shape[3])] * len(images)
