"""Convolutions with the batch normalisation behind them folded in, for faster inference."""

from __future__ import annotations

import re

from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

_CONVOLUTION = re.compile(r"conv(\d*)")


def fold_batch_norms(network: nn.Module) -> None:
    """Fold the normalisations of CLIP's residual networks into their convolutions, in place.

    Pairs named ``conv1`` and ``bn1`` and so on, and ``0`` and ``1`` of a ``downsample``, follow each other there. The
    model computes the same, but can no longer be trained.
    """
    for name, module in network.named_modules():
        children = dict(module.named_children())
        for convolution, norm in _pairs(name, children):
            fused = fuse_conv_bn_eval(children[convolution].eval(), children[norm].eval())
            setattr(module, convolution, fused)
            setattr(module, norm, nn.Identity())


def _pairs(name: str, children: dict[str, nn.Module]) -> list[tuple[str, str]]:
    pairs = [(c, f"bn{match.group(1)}") for c in children if (match := _CONVOLUTION.fullmatch(c))]
    if name.endswith("downsample"):
        pairs.append(("0", "1"))
    return [
        (c, n)
        for c, n in pairs
        if isinstance(children.get(c), nn.Conv2d) and isinstance(children.get(n), nn.BatchNorm2d)
    ]
