"""From images to maps of features."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torchvision.models import resnet50
from torchvision.models.detection.anchor_utils import AnchorGenerator
from torchvision.models.detection.backbone_utils import BackboneWithFPN
from torchvision.models.detection.faster_rcnn import TwoMLPHead
from torchvision.ops import FeaturePyramidNetwork, MultiScaleRoIAlign
from torchvision.ops.feature_pyramid_network import LastLevelMaxPool

from zavis_bt.perception.detector.config import BackboneName

_RATIOS = (0.4, 1.0, 2.5)


@dataclass(frozen=True, slots=True)
class Parts:
    """What depends on the backbone."""

    body: nn.Module
    """(n, 3, h, w) to named maps of ``channels``."""
    channels: int
    anchors: AnchorGenerator
    pool: MultiScaleRoIAlign
    head: nn.Module
    """Pooled maps of boxes to (n, ``features``)."""
    features: int


class _Block(nn.Module):
    """Two 3×3 convolutions with a way around them."""

    def __init__(self, inputs: int, outputs: int, stride: int) -> None:
        super().__init__()
        self.first = _conv(inputs, outputs, 3, stride)
        self.second = _conv(outputs, outputs, 3, 1, active=False)
        same = stride == 1 and inputs == outputs
        self.around = nn.Identity() if same else _conv(inputs, outputs, 1, stride, active=False)

    def forward(self, x: Tensor) -> Tensor:
        return torch.relu(self.second(self.first(x)) + self.around(x))


class TinyBody(nn.Module):
    """A residual network of about 0.7 million parameters with a feature pyramid at strides 4, 8, 16, 32 and 64."""

    def __init__(self, widths: tuple[int, ...] = (24, 32, 64, 96, 128), channels: int = 48) -> None:
        super().__init__()
        stem, *stages = widths
        self.stem = _conv(3, stem, 3, 2)
        inputs = (stem, *stages[:-1])
        self.stages = nn.ModuleList(
            nn.Sequential(_Block(a, b, 2), _Block(b, b, 1)) for a, b in zip(inputs, stages, strict=True)
        )
        self.pyramid = FeaturePyramidNetwork(stages, channels, LastLevelMaxPool(), nn.BatchNorm2d)

        self.features = stages[-1]

    def summary(self, images: Tensor) -> Tensor:
        """Return the mean of the coarsest map before the pyramid, (n, features)."""
        x: Tensor = self.stem(images)
        for stage in self.stages:
            x = stage(x)
        return x.mean(dim=(2, 3))

    def forward(self, images: Tensor) -> dict[str, Tensor]:
        """Return the pyramid's maps, finest first."""
        x, maps = self.stem(images), OrderedDict[str, Tensor]()
        for number, stage in enumerate(self.stages):
            x = maps[str(number)] = stage(x)
        out: dict[str, Tensor] = self.pyramid(maps)
        return out


def _conv(inputs: int, outputs: int, size: int, stride: int, active: bool = True) -> nn.Sequential:
    conv = nn.Conv2d(inputs, outputs, size, stride, size // 2, bias=False)
    layers: list[nn.Module] = [conv, nn.BatchNorm2d(outputs)]
    return nn.Sequential(*layers, nn.ReLU(inplace=True)) if active else nn.Sequential(*layers)


class _NormalisedHead(nn.Sequential):
    """Two layers for a box, normalised: from random weights they learn in a fraction of the time."""

    def __init__(self, inputs: int, features: int) -> None:
        layers: list[nn.Module] = [nn.Flatten()]
        for size in (inputs, features):
            layers += [nn.Linear(size, features, bias=False), nn.LayerNorm(features), nn.ReLU(inplace=True)]
        super().__init__(*layers)


class _C4Body(nn.Module):
    """ResNet-50 to stride 16, as one map."""

    def __init__(self, resnet: nn.Module) -> None:
        super().__init__()
        names = ("conv1", "bn1", "relu", "maxpool", "layer1", "layer2", "layer3")
        self.layers = nn.Sequential(OrderedDict((name, getattr(resnet, name)) for name in names))

    def forward(self, images: Tensor) -> dict[str, Tensor]:
        return {"0": self.layers(images)}


def build_parts(backbone: BackboneName, weights: dict[str, Tensor] | None = None) -> Parts:
    """Return body, anchors and box head of an architecture.

    Args:
        backbone: Which.
        weights: Of torchvision's ResNet-50, to begin with; random if not given.
    """
    if backbone == "tiny":
        return _tiny()
    resnet = resnet50(weights=None)
    if weights is not None:
        resnet.load_state_dict(weights)
    return _fpn(resnet) if backbone == "resnet50_fpn" else _c4(resnet)


def _tiny() -> Parts:
    channels, features, side = 48, 192, 5
    sizes = ((9,), (22,), (50,), (110,), (220,))
    pool = MultiScaleRoIAlign(["0", "1", "2", "3"], side, 1, canonical_scale=80, canonical_level=4)
    head = _NormalisedHead(channels * side * side, features)
    return Parts(TinyBody(channels=channels), channels, AnchorGenerator(sizes, (_RATIOS,) * 5), pool, head, features)


def _fpn(resnet: nn.Module) -> Parts:
    stages = {f"layer{k + 1}": str(k) for k in range(4)}
    body = BackboneWithFPN(resnet, stages, [256, 512, 1024, 2048], 256, LastLevelMaxPool())
    anchors = AnchorGenerator(((32,), (64,), (128,), (256,), (512,)), (_RATIOS,) * 5)
    pool = MultiScaleRoIAlign(["0", "1", "2", "3"], 7, 2)
    return Parts(body, 256, anchors, pool, TwoMLPHead(256 * 49, 1024), 1024)


def _c4(resnet: nn.Module) -> Parts:
    anchors = AnchorGenerator(((32, 64, 128, 256, 512),), (_RATIOS,))
    head = nn.Sequential(resnet.get_submodule("layer4"), nn.AdaptiveAvgPool2d(1), nn.Flatten())
    return Parts(_C4Body(resnet), 1024, anchors, MultiScaleRoIAlign(["0"], 14, 2), head, 2048)
