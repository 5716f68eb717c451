"""The two towers of a CLIP network, which open_clip offers as methods that types know nothing of."""

from __future__ import annotations

from typing import Any, cast

from torch import Tensor, nn


def encode_image(network: nn.Module, images: Tensor) -> Tensor:
    """Return what the image tower makes of images (n, 3, s, s): (n, d), of any length."""
    vectors: Tensor = cast(Any, network).encode_image(images)
    return vectors


def encode_text(network: nn.Module, tokens: Tensor) -> Tensor:
    """Return what the text tower makes of tokens (n, l): (n, d), of any length."""
    vectors: Tensor = cast(Any, network).encode_text(tokens)
    return vectors
