"""Landmarks as JSON: the format ``zavis-semantic-map/1`` of ``semantic_map.json``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from zavis_bt.errors import InputError
from zavis_bt.types import Landmark

FORMAT = "zavis-semantic-map/1"

Number = Annotated[float, Field(allow_inf_nan=False)]
Length = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, le=1)]


class _Entry(BaseModel):
    """A landmark; label and entropy only repeat what the probabilities say, for human readers."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: Annotated[int, Field(ge=0)]
    label: str = ""
    entropy: float = 0.0
    probabilities: Annotated[tuple[tuple[str, Share], ...], Field(min_length=1)]
    position: tuple[Number, Number, Number]
    radius: Length
    views: Annotated[int, Field(ge=1)]

    @model_validator(mode="after")
    def _consistent(self) -> _Entry:
        labels = [label for label, _ in self.probabilities]
        if len(set(labels)) < len(labels):
            raise ValueError("a label occurs twice")
        total = sum(p for _, p in self.probabilities)
        if abs(total - 1) > 1e-3:
            raise ValueError(f"the probabilities sum to {total:.6g}, not to 1")
        return self


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal["zavis-semantic-map/1"]
    landmarks: tuple[_Entry, ...]

    @model_validator(mode="after")
    def _consistent(self) -> _File:
        ids = [landmark.id for landmark in self.landmarks]
        if len(set(ids)) < len(ids):
            raise ValueError("two landmarks have the same id")
        return self


def encode_landmarks(landmarks: Sequence[Landmark]) -> str:
    """Return the file's content: indented JSON."""
    entries = [
        {
            "id": landmark.id,
            "label": landmark.label,
            "entropy": landmark.entropy,
            "probabilities": landmark.probabilities,
            "position": landmark.position,
            "radius": landmark.radius,
            "views": landmark.views,
        }
        for landmark in landmarks
    ]
    return json.dumps({"format": FORMAT, "landmarks": entries}, indent=2, ensure_ascii=False) + "\n"


def decode_landmarks(text: str, where: str) -> tuple[Landmark, ...]:
    """Read the file's content.

    Args:
        text: JSON.
        where: The file's name, for messages.

    Returns:
        The landmarks `encode_landmarks` was given.

    Raises:
        InputError: The text is not a semantic map.
    """
    try:
        file = _File.model_validate_json(text)
    except ValidationError as error:
        fault = error.errors()[0]
        place = "".join(f"{part}: " for part in fault["loc"])
        message = fault["msg"].removeprefix("Value error, ")
        raise InputError(f"{where}: {place}{message} (a semantic map, format {FORMAT})") from error
    return tuple(
        Landmark(entry.id, entry.probabilities, entry.position, entry.radius, entry.views) for entry in file.landmarks
    )
