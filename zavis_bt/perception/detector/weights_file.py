"""A detector in one file: safetensors with its description in the header."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file

from zavis_bt.errors import InputError
from zavis_bt.perception.detector.config import DetectorConfig
from zavis_bt.perception.detector.network import DetectorNetwork

_FORM = "zavis-detector/1"


def save_detector(network: DetectorNetwork, path: Path, facts: Mapping[str, object]) -> None:
    """Write a network, with what it was trained on; in one go, so that a file is whole or not there."""
    tensors = {name: value.detach().cpu().contiguous() for name, value in network.state_dict().items()}
    header = {"form": _FORM, "config": network.config.to_json(), "facts": json.dumps(dict(facts))}
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.part")
    save_file(tensors, part, header)
    part.chmod(0o644)  # the library makes files that nobody else may read
    os.replace(part, path)


def load_detector(path: Path, device: str = "cpu") -> tuple[DetectorNetwork, dict[str, object]]:
    """Return a network, ready to detect, and what it was trained on.

    Raises:
        InputError: The file is missing, damaged, or no detector's.
    """
    try:
        with safe_open(path, framework="pt", device=device) as opened:
            header = opened.metadata() or {}
            names = opened.keys()
            tensors = {name: opened.get_tensor(name) for name in names}
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file (zavis detector export makes one; zavis models list)") from error
    except (SafetensorError, OSError) as error:
        raise InputError(f"{path}: holds no weights that can be read: {error} (export or download it again)") from error
    if header.get("form") != _FORM:
        raise InputError(f"{path}: is no detector of this program (zavis detector export makes one from a training)")
    try:
        config = DetectorConfig.from_json(header["config"])
        network = DetectorNetwork(config)
        network.load_state_dict(tensors)
        facts = json.loads(header.get("facts", "{}"))
    except (RuntimeError, KeyError, ValueError) as error:
        raise InputError(
            f"{path}: weights do not belong to the architecture of their description (export it again)"
        ) from error
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return network.to(device).to(memory_format=torch.channels_last).eval(), facts
