"""The detector that missions use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from zavis_bt.errors import InputError
from zavis_bt.perception.detector.choosing import Chosen, choose
from zavis_bt.perception.detector.config import Choice
from zavis_bt.perception.detector.network import DetectorNetwork
from zavis_bt.perception.detector.weights_file import load_detector
from zavis_bt.types import UNKNOWN_CLASS, Box, Detection, RgbdFrame

_LEAST_SIDE = 32  # of what the network reads; smaller images get a border [px]


class NeuralDetector:
    """Finds things of known classes, and things that are none of them; a `zavis_bt.protocols.Detector`."""

    def __init__(
        self, network: DetectorNetwork, facts: dict[str, object] | None = None, *, width: int | None = None
    ) -> None:
        """Take a network.

        Args:
            network: Trained.
            facts: What it was trained on, for people.
            width: Working width: wider images are scaled down to it [px]; the network's own if not given.
        """
        self.network = network.eval()
        self.facts = facts or {}
        if width is not None:
            network.config = replace(network.config, width=width)
        self._device = next(network.parameters()).device

    @classmethod
    def load(cls, path: Path | str, *, device: str = "cpu", width: int | None = None) -> NeuralDetector:
        """Return the detector in a file that `save_detector` wrote.

        Raises:
            InputError: The file is missing, damaged, or no detector's.
        """
        network, facts = load_detector(Path(path), device)
        return cls(network, facts, width=width)

    @property
    def classes(self) -> tuple[str, ...]:
        """The known classes."""
        return self.network.config.known

    def detect(self, frame: RgbdFrame) -> list[Detection]:
        """Return what a frame shows, best first."""
        return self.detect_image(frame.rgb)

    def detect_image(self, rgb: NDArray[np.uint8]) -> list[Detection]:
        """Return what an image (h, w, 3) shows, best first; boxes in its pixels.

        Raises:
            InputError: It is no image.
        """
        return self.detect_by(rgb, [self.network.config.choice])[0]

    def detect_by(self, rgb: NDArray[np.uint8], choices: Sequence[Choice]) -> list[list[Detection]]:
        """Return the same for each of several ways to choose among the boxes of one look.

        Raises:
            InputError: It is no image.
        """
        if rgb.ndim != 3 or rgb.shape[2] != 3 or not rgb.size:
            raise InputError(f"image: has the shape {rgb.shape} (height, width and 3 colours are needed)")
        small, scale = _fitted(rgb, self.network.config.width)
        image = torch.from_numpy(small).to(self._device).permute(2, 0, 1)[None].float() / 255
        with torch.inference_mode():
            regions = self.network(image.contiguous(memory_format=torch.channels_last))[0]
            chosen = [choose(regions, self.network, choice) for choice in choices]
        return [self._detections(found, scale, rgb.shape[1::-1]) for found in chosen]

    def _detections(self, found: Chosen, scale: tuple[float, float], size: tuple[int, ...]) -> list[Detection]:
        boxes = (found.boxes.cpu().double().numpy() * (*scale, *scale)).clip(0, (*size, *size))
        rows = zip(boxes.tolist(), found.labels.tolist(), found.scores.tolist(), strict=True)
        shares, unsure, vague = (
            each.tolist() for each in (found.probabilities.double(), found.epistemic, found.aleatoric)
        )
        detections = []
        for k, (box, label, score) in enumerate(rows):
            if box[2] - box[0] <= 0 or box[3] - box[1] <= 0:
                continue  # in the border of a tiny image
            is_known = label < len(self.classes)
            name = self.classes[label] if is_known else UNKNOWN_CLASS
            probabilities = tuple(zip(self.classes, _summing_to_one(shares[k]), strict=True)) if is_known else ()
            detections.append(Detection(Box(*box), name, score, probabilities, max(unsure[k], 0.0), max(vague[k], 0.0)))
        return detections


def _fitted(rgb: NDArray[np.uint8], width: int) -> tuple[NDArray[np.uint8], tuple[float, float]]:
    """Return the image no wider (or, if upright, higher) than ``width``, and what its coordinates are multiplied by."""
    height, full = rgb.shape[:2]
    factor = min(width / max(full, height), 1.0)
    w, h = max(round(full * factor), 1), max(round(height * factor), 1)
    small = rgb if (h, w) == (height, full) else np.asarray(cv2.resize(rgb, (w, h), interpolation=cv2.INTER_AREA))
    if min(w, h) < _LEAST_SIDE:
        border = (0, max(_LEAST_SIDE - h, 0), 0, max(_LEAST_SIDE - w, 0))
        small = np.asarray(cv2.copyMakeBorder(small, *border, cv2.BORDER_CONSTANT, value=(114, 114, 114)))
    return np.array(small, dtype=np.uint8, order="C"), (full / w, height / h)  # frames are read-only, tensors never


def _summing_to_one(shares: list[float]) -> list[float]:
    total = sum(shares)
    return [share / total for share in shares] if total > 0 else [1 / len(shares)] * len(shares)
