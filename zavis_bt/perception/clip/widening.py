"""Making the image tower of a residual CLIP network wider, so that it says the same and can learn more.

New channels are copies of old ones, and whoever reads a channel reads each of its copies with its share of the weight
(Chen, Goodfellow and Shlens, "Net2Net", ICLR 2016).
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

from zavis_bt.errors import InputError

_NORM = ("weight", "bias", "running_mean", "running_var")
_HEAD = 64  # channels of an attention head
_EXPANSION = 4  # of a residual block's outputs over its width
_EMBEDDING = 32  # channels of the attention pooling, per channel of the tower's width


def widened_config(config: Mapping[str, Any], width: int) -> dict[str, Any]:
    """Return an architecture in open_clip's form with an image tower of another width.

    Raises:
        InputError: The tower is none of residual blocks, or cannot be made that wide.
    """
    vision = config["vision_cfg"]
    if not isinstance(vision.get("layers"), list) or vision.get("head_width", _HEAD) != _HEAD:
        raise InputError("widen: only image towers of residual blocks can be made wider (with heads of 64 channels)")
    if width <= vision["width"] or width % 2:
        raise InputError(f"widen: the image tower is {vision['width']} wide (--width: an even number above)")
    wider = copy.deepcopy(dict(config))
    wider["vision_cfg"]["width"] = width
    return wider


def widen(
    weights: Mapping[str, Tensor], config: Mapping[str, Any], width: int, *, noise: float = 0.0, seed: int = 0
) -> dict[str, Tensor]:
    """Return the weights of a network whose image tower is wider and, without noise, gives the same vectors.

    Args:
        weights: Of the network, by name.
        config: Its architecture in open_clip's form.
        width: Of the new image tower.
        noise: Standard deviation of a factor of each weight about 1: copies that are the same learn the same.
        seed: Of the choice of copies, and of the noise.

    Raises:
        InputError: The tower is none of residual blocks, or cannot be made that wide.
    """
    widened_config(config, width)
    vision = config["vision_cfg"]
    tower = _Tower(weights, int(vision["width"]), width, noise, torch.Generator().manual_seed(seed))
    tower.widen([int(count) for count in vision["layers"]])
    return tower.weights


class _Tower:
    """The image tower of a network on its way to be wider."""

    def __init__(self, weights: Mapping[str, Tensor], old: int, new: int, noise: float, rng: torch.Generator) -> None:
        self.weights = {name: value.clone() for name, value in weights.items()}
        self._old, self._new, self._noise, self._rng = old, new, noise, rng

    def widen(self, layers: list[int]) -> None:
        """Widen stem, blocks and pooling; ``layers`` has the number of blocks of each stage."""
        reads: Tensor | None = None
        for number, channels in enumerate((self._old // 2, self._old // 2, self._old), start=1):
            writes = self._copies(channels)
            self._convolution(f"conv{number}", f"bn{number}", reads, writes)
            reads = writes
        for stage, blocks in enumerate(layers):
            inner = self._old * 2**stage
            outer = self._copies(inner * _EXPANSION)
            for block in range(blocks):
                assert reads is not None
                self._block(f"layer{stage + 1}.{block}", reads, inner, outer)
                reads = outer
        assert reads is not None
        self._pooling(reads)

    def _block(self, name: str, reads: Tensor, inner: int, outer: Tensor) -> None:
        first, second = self._copies(inner), self._copies(inner)
        self._convolution(f"{name}.conv1", f"{name}.bn1", reads, first)
        self._convolution(f"{name}.conv2", f"{name}.bn2", first, second)
        self._convolution(f"{name}.conv3", f"{name}.bn3", second, outer)
        if f"visual.{name}.downsample.0.weight" in self.weights:
            self._convolution(f"{name}.downsample.0", f"{name}.downsample.1", reads, outer)

    def _pooling(self, reads: Tensor) -> None:
        heads = torch.arange(_EMBEDDING * self._old).reshape(-1, _HEAD)
        writes = heads[torch.arange(_EMBEDDING * self._new // _HEAD) % len(heads)].flatten()
        name, weights = "visual.attnpool", self.weights
        weights[f"{name}.positional_embedding"] = weights[f"{name}.positional_embedding"][:, reads]
        for part in (f"{name}.q_proj", f"{name}.k_proj", f"{name}.v_proj"):
            weights[f"{part}.weight"] = self._noisy(weights[f"{part}.weight"][writes][:, reads] * _shares(reads))
            weights[f"{part}.bias"] = weights[f"{part}.bias"][writes]
        weights[f"{name}.c_proj.weight"] = self._noisy(weights[f"{name}.c_proj.weight"][:, writes] * _shares(writes))

    def _convolution(self, name: str, norm: str, reads: Tensor | None, writes: Tensor) -> None:
        kernel = self.weights[f"visual.{name}.weight"][writes]
        if reads is not None:
            kernel = kernel[:, reads] * _shares(reads)[:, None, None]
        self.weights[f"visual.{name}.weight"] = self._noisy(kernel)
        for part in _NORM:
            self.weights[f"visual.{norm}.{part}"] = self.weights[f"visual.{norm}.{part}"][writes]

    def _copies(self, channels: int) -> Tensor:
        """Return which old channel each new one is a copy of: all of them, then some once more, chosen at random."""
        more = channels * self._new // self._old - channels
        rounds = [torch.randperm(channels, generator=self._rng) for _ in range(-(-more // channels))]
        return torch.cat([torch.arange(channels), *rounds])[: channels + more]

    def _noisy(self, values: Tensor) -> Tensor:
        return values * (1 + self._noise * torch.randn(values.shape, generator=self._rng))


def _shares(copies: Tensor) -> Tensor:
    """Return one over the number of copies that each channel is one of."""
    return 1 / torch.bincount(copies)[copies].float()
