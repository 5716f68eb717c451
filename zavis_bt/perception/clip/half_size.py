"""Showing a residual CLIP network smaller images than it is made for, to begin its training fast."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import torch
import torch.nn.functional as F
from open_clip.modified_resnet import ModifiedResNet
from torch import Tensor, nn

_STRIDE = 32  # of the network's last feature map


def can_halve(visual: nn.Module, size: int) -> bool:
    """Return whether an image tower can read squares of half its size."""
    return isinstance(visual, ModifiedResNet) and size % (2 * _STRIDE) == 0


@contextmanager
def reading_half_size(visual: nn.Module, size: int) -> Iterator[None]:
    """Let an image tower read squares of half its size: its positional embedding is pooled to the smaller grid."""
    pooling = visual.get_submodule("attnpool")
    embedding = pooling.get_parameter("positional_embedding")
    del pooling._parameters["positional_embedding"]
    pooling.positional_embedding = _pooled(embedding, size // _STRIDE)
    try:
        yield
    finally:
        del pooling.positional_embedding
        pooling.register_parameter("positional_embedding", embedding)


def _pooled(embedding: Tensor, side: int) -> Tensor:
    grid = embedding[1:].T.reshape(1, -1, side, side)
    half = F.adaptive_avg_pool2d(grid, side // 2).flatten(2)[0].T
    return torch.cat([embedding[:1], half])
