"""Making the image tower of a residual CLIP network deeper, so that it says the same and can learn more.

A new block comes last in its stage and adds nothing to what it reads until it has learnt to (Goyal et al., "Accurate,
large minibatch SGD", 2017, section 5.1: the last norm of a residual block begins at zero).
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import open_clip
import torch
from torch import Tensor

from zavis_bt.errors import InputError


def deepened_config(config: Mapping[str, Any], layers: Sequence[int]) -> dict[str, Any]:
    """Return an architecture in open_clip's form with an image tower of other numbers of blocks.

    Raises:
        InputError: The tower is none of residual blocks, or a stage would lose blocks, or none would gain any.
    """
    old = config["vision_cfg"].get("layers")
    if not isinstance(old, list):
        raise InputError("deepen: only image towers of residual blocks can be made deeper")
    if len(layers) != len(old) or any(new < had for new, had in zip(layers, old, strict=True)) or [*layers] == old:
        told = ",".join(map(str, old))
        raise InputError(f"deepen: the image tower has {told} blocks (--layers: {len(old)} numbers, none below these)")
    deeper = copy.deepcopy(dict(config))
    deeper["vision_cfg"]["layers"] = [*layers]
    return deeper


def deepen(
    weights: Mapping[str, Tensor], config: Mapping[str, Any], layers: Sequence[int], *, seed: int = 0
) -> dict[str, Tensor]:
    """Return the weights of a network whose image tower has more blocks and gives the same vectors.

    Args:
        weights: Of the network, by name.
        config: Its architecture in open_clip's form.
        layers: Number of blocks of each stage.
        seed: Of the weights inside the new blocks.

    Raises:
        InputError: The tower is none of residual blocks, or a stage would lose blocks, or none would gain any.
    """
    deeper = deepened_config(config, layers)
    with torch.random.fork_rng(devices=()):
        torch.manual_seed(seed)
        fresh = open_clip.CLIP(**deeper).state_dict()
    silent = {name for name in fresh if name not in weights and name.endswith("bn3.weight")}
    return {
        name: torch.zeros_like(value) if name in silent else weights.get(name, value).clone()
        for name, value in fresh.items()
    }
