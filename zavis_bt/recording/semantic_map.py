"""The semantic map as a file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from zavis_bt.errors import InputError
from zavis_bt.recording.plain import to_json
from zavis_bt.types import Landmark

FORMAT = "zavis-semantic-map/1"


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid")

    id: int
    label: str
    entropy: float
    probabilities: list[tuple[str, float]]
    position: tuple[float, float, float]
    radius: float
    views: int


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid")

    format: str
    landmarks: list[_Entry]


def landmarks_to_json(landmarks: Sequence[Landmark]) -> str:
    """Return the text of a ``semantic_map.json``; labels and entropies [nat] are repeated for human readers."""
    return to_json({"format": FORMAT, "landmarks": [_to_entry(landmark) for landmark in landmarks]})


def load_landmarks(path: Path | str) -> tuple[Landmark, ...]:
    """Read a ``semantic_map.json``.

    Raises:
        InputError: The file is missing, is not JSON or not a semantic map.
    """
    try:
        content = _File.model_validate(json.loads(Path(path).read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except ValidationError as error:
        fault = error.errors()[0]
        where = ".".join(str(part) for part in fault["loc"])
        raise InputError(f"{path}: {where}: {fault['msg']} (a semantic map, format {FORMAT})") from error
    except ValueError as error:
        raise InputError(f"{path}: not JSON: {error}") from error
    if content.format != FORMAT:
        raise InputError(f"{path}: format is {content.format!r} ({FORMAT!r} would be right)")
    return tuple(_to_landmark(entry) for entry in content.landmarks)


def _to_entry(landmark: Landmark) -> dict[str, Any]:
    return {
        "id": landmark.id,
        "label": landmark.label,
        "entropy": landmark.entropy,
        "probabilities": landmark.probabilities,
        "position": landmark.position,
        "radius": landmark.radius,
        "views": landmark.views,
    }


def _to_landmark(entry: _Entry) -> Landmark:
    return Landmark(entry.id, tuple(entry.probabilities), entry.position, entry.radius, entry.views)
