"""A training's state on disk."""

from __future__ import annotations

import os
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from zavis_bt.errors import InputError
from zavis_bt.perception.detector.config import DetectorConfig

CHECKPOINT = "checkpoint.pt"
_FORM = "zavis-detector-training/1"


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """All that a training needs to go on."""

    config: DetectorConfig
    done: int
    """Iterations behind."""
    iterations: int
    """Iterations in all."""
    weights: dict[str, Tensor]
    optimiser: dict[str, Any]
    """Of optimiser, learning rate and mixed precision."""

    def save(self, folder: Path) -> None:
        """Write the state in one go: a power cut leaves the one before."""
        part = folder / f".{CHECKPOINT}.part"
        content = {
            "form": _FORM,
            "config": self.config.to_json(),
            "done": self.done,
            "iterations": self.iterations,
            "weights": self.weights,
            "optimiser": self.optimiser,
        }
        torch.save(content, part)
        os.replace(part, folder / CHECKPOINT)

    @classmethod
    def load(cls, folder: Path) -> Checkpoint:
        """Return the state in a training's folder.

        Raises:
            InputError: There is none, or it cannot be read.
        """
        path = folder / CHECKPOINT
        try:
            content = torch.load(path, map_location="cpu", weights_only=True)
        except FileNotFoundError as error:
            raise InputError(f"{folder}: holds no training (begin one: zavis detector train)") from error
        except (RuntimeError, OSError, EOFError, pickle.UnpicklingError) as error:
            first = str(error).partition("\n")[0]
            raise InputError(f"{path}: cannot be read: {first} (train again without --resume)") from error
        if not isinstance(content, dict) or content.get("form") != _FORM:
            raise InputError(f"{path}: is no detector's training (name the --out folder of zavis detector train)")
        config = DetectorConfig.from_json(content["config"])
        return cls(config, *(content[name] for name in ("done", "iterations", "weights", "optimiser")))
