"""``semantic_map.json``: landmarks for everybody to read, with the evidence needed to go on fusing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from zavis_bt.errors import InputError
from zavis_bt.mapping.evidence import Evidence

FORMAT: Literal["zavis-semantic-map/1"] = "zavis-semantic-map/1"

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Length = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Id = Annotated[int, Field(ge=0)]


class SemanticState(NamedTuple):
    """All that a semantic map holds."""

    evidence: dict[int, Evidence]
    """By landmark id, oldest first."""
    merged: dict[int, int]
    """Ids that are no more, and the older ids they were merged into."""
    visited: set[int]
    next_id: int


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Evidence(_Strict):
    weight: Positive
    log_sums: Annotated[dict[str, Number], Field(min_length=1)]
    position_sums: tuple[Number, Number, Number]
    square_sum: Length
    largest: Length


class _Landmark(_Strict):
    id: Id
    label: str
    probabilities: dict[str, Number]
    position: tuple[Number, Number, Number]
    radius: Length
    views: Annotated[int, Field(ge=1)]
    visited: bool
    evidence: _Evidence


class _File(_Strict):
    format: Literal["zavis-semantic-map/1"]
    landmarks: list[_Landmark]
    merged: dict[Id, Id]
    next_id: Id

    @model_validator(mode="after")
    def _consistent(self) -> _File:
        ids = [landmark.id for landmark in self.landmarks]
        if ids != sorted(set(ids)):
            raise ValueError("landmark ids must be unique and increasing")
        for gone, kept in self.merged.items():
            if gone in ids or kept >= gone or not (kept in ids or kept in self.merged):
                raise ValueError(f"merged: {gone} cannot have become part of {kept} (an older landmark)")
        if max([-1, *ids, *self.merged]) >= self.next_id:
            raise ValueError(f"next_id {self.next_id} must be greater than every id")
        return self


def encode(state: SemanticState) -> str:
    """Return the file's content: indented JSON."""
    landmarks = [_landmark(id, evidence, id in state.visited) for id, evidence in state.evidence.items()]
    file = _File(format=FORMAT, landmarks=landmarks, merged=state.merged, next_id=state.next_id)
    return file.model_dump_json(indent=2) + "\n"


def decode(text: str, where: str) -> SemanticState:
    """Read the file's content.

    Args:
        text: JSON.
        where: The file's name, for messages.

    Returns:
        What `encode` was given.

    Raises:
        InputError: The text is not a semantic map.
    """
    try:
        file = _File.model_validate_json(text)
    except ValidationError as error:
        fault = error.errors()[0]
        place = ".".join(str(part) for part in fault["loc"])
        raise InputError(
            f"{where}: {place + ': ' if place else ''}{fault['msg'].removeprefix('Value error, ')}"
        ) from error
    return SemanticState(
        {landmark.id: _evidence(landmark) for landmark in file.landmarks},
        dict(file.merged),
        {landmark.id for landmark in file.landmarks if landmark.visited},
        file.next_id,
    )


def _landmark(id: int, evidence: Evidence, visited: bool) -> _Landmark:
    return _Landmark(
        id=id,
        label=evidence.label,
        probabilities=_plain(evidence.probabilities),
        position=evidence.position,
        radius=evidence.radius,
        views=evidence.views,
        visited=visited,
        evidence=_Evidence(
            weight=evidence.weight,
            log_sums=_plain(evidence.log_sums),
            position_sums=evidence.position_sums,
            square_sum=evidence.square_sum,
            largest=evidence.largest,
        ),
    )


def _evidence(landmark: _Landmark) -> Evidence:
    sums = landmark.evidence
    return Evidence(sums.weight, landmark.views, sums.log_sums, sums.position_sums, sums.square_sum, sums.largest)


def _plain(values: Mapping[str, float]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}
