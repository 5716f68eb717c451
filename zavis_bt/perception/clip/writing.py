"""Writing a trained model as a folder that open_clip loads."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save_file
from torch import Tensor

from zavis_bt.perception.clip.crops import Preprocessing
from zavis_bt.perception.clip.loading import CONFIG, WEIGHTS

_EXACT = ("running_mean", "running_var", "logit_scale")  # kept in single precision


def write_model(
    folder: Path,
    config: Mapping[str, Any],
    preprocessing: Preprocessing,
    weights: Mapping[str, Tensor],
    facts: Mapping[str, Any],
) -> None:
    """Write a model in half precision, with its configuration and what is worth knowing of its training.

    Args:
        folder: Made if it is not there.
        config: Its architecture in open_clip's form.
        preprocessing: How it reads images.
        weights: By name.
        facts: Of the training.
    """
    folder.mkdir(parents=True, exist_ok=True)
    document = {
        "model_cfg": dict(config),
        "preprocess_cfg": {
            "mean": preprocessing.mean,
            "std": preprocessing.std,
            "interpolation": preprocessing.interpolation,
            "resize_mode": "longest",
        },
        "training": dict(facts),
    }
    (folder / CONFIG).write_text(json.dumps(document, indent=1) + "\n")
    save_file({name: _packed(name, value) for name, value in weights.items()}, folder / WEIGHTS)
    (folder / WEIGHTS).chmod(0o644)  # like any other file


def _packed(name: str, value: Tensor) -> Tensor:
    exact = value.dtype != torch.float32 or name.endswith(_EXACT)
    return (value if exact else value.half()).contiguous().cpu().clone()
