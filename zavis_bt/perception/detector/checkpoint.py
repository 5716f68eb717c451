"""A detector's training, as it is kept on disk."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torch import Tensor

from zavis_bt.perception.detector.config import DetectorConfig
from zavis_bt.perception.training.kept_state import KeptState

_KEPT = KeptState("zavis-detector-training/1", "zavis detector train")


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
        """Write the state in one go."""
        content = {
            "config": self.config.to_json(),
            "done": self.done,
            "iterations": self.iterations,
            "weights": self.weights,
            "optimiser": self.optimiser,
        }
        _KEPT.save(folder, content)

    @classmethod
    def load(cls, folder: Path) -> Checkpoint:
        """Return the state in a training's folder.

        Raises:
            InputError: There is none, or it cannot be read.
        """
        content = _KEPT.load(folder)
        config = DetectorConfig.from_json(content["config"])
        return cls(config, *(content[name] for name in ("done", "iterations", "weights", "optimiser")))
