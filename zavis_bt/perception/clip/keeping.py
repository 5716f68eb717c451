"""A training's state on disk."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import torch

from zavis_bt.errors import InputError

CHECKPOINT = "checkpoint.pt"
_FORM = "zavis-matcher-training/1"


def save_state(folder: Path, state: dict[str, Any]) -> None:
    """Write a state in one go: a power cut leaves the one before."""
    part = folder / f".{CHECKPOINT}.part"
    torch.save({"form": _FORM, **state}, part)
    os.replace(part, folder / CHECKPOINT)


def load_state(folder: Path) -> dict[str, Any]:
    """Return the state in a training's folder.

    Raises:
        InputError: There is none, or it cannot be read.
    """
    path = folder / CHECKPOINT
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)
    except FileNotFoundError as error:
        raise InputError(f"{folder}: holds no training (begin one without --resume)") from error
    except Exception as error:  # whatever unpickling a broken file raises
        first = str(error).partition("\n")[0]
        raise InputError(f"{path}: cannot be read: {first} (train again without --resume)") from error
    if not isinstance(state, dict) or state.get("form") != _FORM:
        raise InputError(f"{path}: is no matcher's training (name the --out folder of zavis matcher train)")
    return dict(state)
