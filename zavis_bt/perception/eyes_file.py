"""Eyes files: ``format: zavis-eyes/1``, which weights to see with and what their scores mean.

Files and folders that exist beside the eyes file are taken from there; other names are those of weights or models.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from zavis_bt.documents import check, read_document
from zavis_bt.errors import InputError
from zavis_bt.perception.calibration import Thresholds
from zavis_bt.perception.contrast import Contrast
from zavis_bt.perception.eyes import EyesSettings, find_eyes, is_file

FORMAT = "zavis-eyes/1"

Number = Annotated[float, Field(allow_inf_nan=False)]
Text = Annotated[str, Field(min_length=1)]


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Thresholds(_Entry):
    match: Number
    landmark: Number
    temperature: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    detection: Annotated[float, Field(ge=0, lt=1)] = 0.0
    known: Annotated[float, Field(ge=0, lt=1)] = 0.0
    trust: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0


class _Contrast(_Entry):
    temperature: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    texts: Annotated[tuple[Text, ...], Field(min_length=1)]


class _Calibrated(_Entry):
    """Where the thresholds come from; only the checksums are read again."""

    model_config = ConfigDict(extra="allow", frozen=True)

    weights: dict[Literal["detector", "clip"], Text] = Field(default_factory=dict)


class _File(_Entry):
    format: Literal["zavis-eyes/1"]
    perception: Text = "neural"
    detector: Text | None = None
    clip: Text | None = None
    device: Text = "cpu"
    widths: tuple[Annotated[int, Field(ge=32, le=8192)], ...] = ()
    thresholds: _Thresholds | None = None
    contrast: _Contrast | None = None
    calibrated: _Calibrated | None = None
    options: dict[str, Any] = Field(default_factory=dict)


def read_eyes(path: Path) -> tuple[str, EyesSettings]:
    """Return the name of the eyes of a file, and their settings.

    Raises:
        InputError: The file is missing or wrong; one line for each fault.
    """
    document = read_document(path)
    file, faults = check(document, _File)
    if file is None:
        raise InputError("\n".join(faults))
    if is_file(file.perception):
        raise InputError(f"{document.where('perception')}: perception: should be a name, such as neural, not a file")
    find_eyes(file.perception)
    settings = EyesSettings(
        detector=_beside(path, file.detector),
        clip=_beside(path, file.clip),
        device=file.device,
        widths=file.widths,
        thresholds=None if file.thresholds is None else Thresholds(**file.thresholds.model_dump()),
        contrast=None if file.contrast is None else Contrast(file.contrast.texts, file.contrast.temperature),
        checksums=() if file.calibrated is None else tuple(sorted(file.calibrated.weights.items())),
        options=file.options,
        where=str(path),
    )
    return file.perception, settings


def write_eyes(path: Path, settings: EyesSettings, calibrated: Mapping[str, Any]) -> None:
    """Write an eyes file for neural eyes.

    Args:
        path: The file; written over if it exists.
        settings: Weights and thresholds.
        calibrated: Where the thresholds come from, as YAML's types.

    Raises:
        InputError: The file cannot be written.
    """
    from ruamel.yaml import YAML

    entries: dict[str, Any] = {"format": FORMAT, "perception": "neural"}
    weights = {"detector": settings.detector, "clip": settings.clip}
    entries |= {kind: _seen_from(path, name) for kind, name in weights.items() if name is not None}
    if settings.device != "cpu":
        entries["device"] = settings.device
    if settings.widths:
        entries["widths"] = _flow_list(settings.widths)
    if settings.thresholds is not None:
        entries["thresholds"] = asdict(settings.thresholds)
    if settings.contrast is not None:
        entries["contrast"] = {
            "temperature": settings.contrast.temperature,
            "texts": _flow_list(settings.contrast.texts),
        }
    entries["calibrated"] = {**calibrated, "weights": dict(settings.checksums)}
    yaml = YAML()
    yaml.indent(mapping=2, sequence=4, offset=2)
    yaml.width = 4096
    try:
        with path.open("w", encoding="utf-8") as stream:
            yaml.dump(entries, stream)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error


def _flow_list(values: Sequence[str] | Sequence[int]) -> Any:
    """Return a list that is written in one line."""
    from ruamel.yaml.comments import CommentedSeq

    listed = CommentedSeq(values)
    listed.fa.set_flow_style()
    return listed


def _beside(file: Path, name: str | None) -> str | None:
    """Return the path of what lies beside the file, or the name as it is."""
    if name is None:
        return None
    model, at, pretrained = name.rpartition("@")
    path = file.parent / pretrained
    return f"{model}{at}{path}" if path.exists() else name


def _seen_from(file: Path, name: str) -> str:
    """Return the path from the file's folder to what exists under a name, or the name as it is."""
    model, at, pretrained = name.rpartition("@")
    if not Path(pretrained).exists():
        return name
    return f"{model}{at}{os.path.relpath(pretrained, file.parent)}"
