"""Making networks, and detectors from trainings."""

from __future__ import annotations

import json
import pickle
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import torch
from torch import Tensor

from zavis_bt.errors import InputError
from zavis_bt.perception.detector.checkpoint import Checkpoint
from zavis_bt.perception.detector.config import DetectorConfig
from zavis_bt.perception.detector.network import DetectorNetwork
from zavis_bt.perception.detector.weights_file import load_detector, save_detector
from zavis_bt.perception.training.averaging import averaged_weights

FACTS = "facts.json"
DEFAULT_KNOWN = (
    *(
        "chair",
        "sofa",
        "dining table",
        "tv",
        "plant",
        "bottle",
        "fridge",
        "oven",
        "microwave",
        "sink",
        "toilet",
        "toaster",
    ),
    *("backpack", "suitcase", "handbag", "umbrella", "vase", "cup", "bench", "washing machine"),
)
"""Household classes that the data sets COCO and Pascal VOC name, too, or nearly."""


def build_network(config: DetectorConfig, seed: int, weights: Path | None = None) -> DetectorNetwork:
    """Return a network that is not trained yet.

    Args:
        config: Which.
        seed: Of its weights.
        weights: torchvision's checkpoint of ResNet-50 to begin with.

    Raises:
        InputError: The checkpoint cannot be read, or is another architecture's.
    """
    backbone = None if weights is None else _resnet(weights, config)
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        try:
            return DetectorNetwork(config, backbone)
        except RuntimeError as error:
            raise InputError(f"{weights}: is no ResNet-50 of torchvision's (zavis models list names one)") from error


def export_training(folder: Path, out: Path, width: int | None, choice: dict[str, float]) -> None:
    """Write a training's detector as one file.

    Args:
        folder: Of the training.
        out: File to write.
        width: Working width [px]; the training's if not given.
        choice: Changes of how boxes are chosen, by the names in `Choice`.

    Raises:
        InputError: The folder holds no training, or none that came to its end.
    """
    state = Checkpoint.load(folder)
    if state.done < state.iterations:
        raise InputError(
            f"{folder}: the training stopped at {state.done} of {state.iterations} iterations "
            "(go on: zavis detector train --resume)"
        )
    config = state.config.with_choice(**choice)
    network = DetectorNetwork(replace(config, width=width or config.width))
    network.load_state_dict(state.weights)
    facts = folder / FACTS
    save_detector(network, out, json.loads(facts.read_text()) if facts.is_file() else {})


def average_detectors(files: Sequence[Path], out: Path) -> None:
    """Write the mean of detectors that trained on from the same weights, as one file.

    Args:
        files: Of the detectors; thresholds are the last one's.
        out: File to write.

    Raises:
        InputError: A file is no detector's, there are fewer than two, or their classes or architectures differ.
    """
    opened = [load_detector(file) for file in files]
    weights = averaged_weights([network.state_dict() for network, _ in opened])
    network = opened[-1][0]
    for file, (other, _) in zip(files, opened, strict=True):
        if (other.config.method, other.config.known) != (network.config.method, network.config.known):
            raise InputError(f"average: {file} and {files[-1]} differ in method or classes (name trainings of one)")
    network.load_state_dict(weights)
    save_detector(network, out, {**opened[-1][1], "average_of": len(files)})


def _resnet(path: Path, config: DetectorConfig) -> dict[str, Tensor]:
    if config.backbone == "tiny":
        raise InputError("--weights: belong to ResNet-50 (choose --backbone resnet50_fpn or resnet50_c4)")
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
    except (OSError, RuntimeError, EOFError, pickle.UnpicklingError) as error:
        first = str(error).partition("\n")[0]
        raise InputError(f"{path}: cannot be read: {first} (download it again: zavis models list)") from error
    if not isinstance(content, dict) or "layer4.2.conv3.weight" not in content:
        raise InputError(f"{path}: is no ResNet-50 of torchvision's (zavis models list names one)")
    return content
