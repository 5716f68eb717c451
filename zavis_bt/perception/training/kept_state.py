"""States of trainings on disk, from which they go on."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from zavis_bt.errors import InputError

CHECKPOINT = "checkpoint.pt"


@dataclass(frozen=True, slots=True)
class KeptState:
    """Where trainings of one kind keep their states."""

    form: str
    """Written into the file, so that no other kind of training takes it for its own."""
    command: str
    """That begins such a training, for error messages."""

    def save(self, folder: Path, state: dict[str, Any]) -> None:
        """Write a state in one go: a power cut leaves the one before."""
        part = folder / f".{CHECKPOINT}.part"
        torch.save({"form": self.form, **state}, part)
        os.replace(part, folder / CHECKPOINT)

    def load(self, folder: Path) -> dict[str, Any]:
        """Return the state in a training's folder.

        Raises:
            InputError: There is none, it cannot be read, or it is of another kind.
        """
        path = folder / CHECKPOINT
        try:
            state = torch.load(path, map_location="cpu", weights_only=True)
        except FileNotFoundError as error:
            raise InputError(f"{folder}: holds no training (begin one without --resume: {self.command})") from error
        except Exception as error:  # a broken pickle calls things with wrong arguments: any type
            first = str(error).partition("\n")[0]
            raise InputError(f"{path}: cannot be read: {first} (train again without --resume)") from error
        if not isinstance(state, dict) or state.get("form") != self.form:
            raise InputError(f"{path}: is of another kind of training (name the --out folder of {self.command})")
        return dict(state)
