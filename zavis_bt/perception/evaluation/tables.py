"""Predictions and ground truth of many images as columns."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.perception.datasets import DetectionDataset, project_name
from zavis_bt.perception.naming import key
from zavis_bt.types import UNKNOWN_CLASS, Box, FloatArray


@dataclass(frozen=True, slots=True)
class Prediction:
    """One detection in one image of a data set."""

    image: int
    """Index in the data set."""
    box: Box
    """In pixels of the full image."""
    label: str
    """A known class, or `UNKNOWN_CLASS`."""
    score: float


@dataclass(frozen=True, slots=True)
class Truth:
    """One thing that is really in an image of a data set."""

    image: int
    box: Box
    label: str
    """Its category; all that are not known classes count as `UNKNOWN_CLASS`."""
    ignored: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """Boxes as columns, with classes as numbers: known ones by their place, `UNKNOWN_CLASS` last."""

    image: NDArray[np.intp]
    box: FloatArray
    """(n, 4) x0, y0, x1, y1 [px]."""
    label: NDArray[np.intp]
    score: FloatArray
    """Of predictions; 1 for ground truth."""
    ignored: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.image)

    def of(self, label: int) -> NDArray[np.bool_]:
        """Return which boxes are of a class and count."""
        mask: NDArray[np.bool_] = (self.label == label) & ~self.ignored
        return mask


class Classes:
    """The known classes by number; their spelling does not matter."""

    def __init__(self, known: Sequence[str]) -> None:
        self.names = tuple(known)
        self._numbers: Mapping[str, int] = {key(project_name(name)): k for k, name in enumerate(known)}
        if len(self._numbers) != len(self.names) or key(UNKNOWN_CLASS) in self._numbers:
            raise InputError(f"known classes: each once, and none is '{UNKNOWN_CLASS}' (are: {', '.join(known)})")
        self.unknown = len(self.names)

    def predicted(self, label: str) -> int:
        """Return the number of a detection's label.

        Raises:
            InputError: It is neither a known class nor `UNKNOWN_CLASS`.
        """
        if label == UNKNOWN_CLASS:
            return self.unknown
        number = self._numbers.get(key(project_name(label)))
        if number is None:
            raise InputError(f"detections: '{label}' is not one of the known classes{did_you_mean(label, self.names)}")
        return number

    def true(self, category: str) -> int:
        """Return the number of a thing's category."""
        return self._numbers.get(key(project_name(category)), self.unknown)


def prediction_table(predictions: Sequence[Prediction], classes: Classes) -> Table:
    """Return predictions as columns.

    Raises:
        InputError: A label is neither a known class nor `UNKNOWN_CLASS`.
    """
    numbers = {label: classes.predicted(label) for label in {p.label for p in predictions}}
    return Table(
        np.array([p.image for p in predictions], dtype=np.intp),
        _boxes([p.box for p in predictions]),
        np.array([numbers[p.label] for p in predictions], dtype=np.intp),
        np.array([p.score for p in predictions], dtype=np.float64),
        np.zeros(len(predictions), dtype=np.bool_),
    )


def truth_table(truths: Sequence[Truth], classes: Classes) -> Table:
    """Return ground truth as columns, sorted by image."""
    ordered = sorted(truths, key=lambda truth: truth.image)
    numbers = {label: classes.true(label) for label in {t.label for t in ordered}}
    return Table(
        np.array([t.image for t in ordered], dtype=np.intp),
        _boxes([t.box for t in ordered]),
        np.array([numbers[t.label] for t in ordered], dtype=np.intp),
        np.ones(len(ordered), dtype=np.float64),
        np.array([t.ignored for t in ordered], dtype=np.bool_),
    )


def truths_of(dataset: DetectionDataset, indices: Iterable[int] | None = None) -> list[Truth]:
    """Return the ground truth of a data set, or of some of its images."""
    chosen = range(len(dataset)) if indices is None else indices
    return [Truth(i, a.box, a.category, a.ignored) for i in chosen for a in dataset.annotations(i)]


def _boxes(boxes: Sequence[Box]) -> FloatArray:
    return np.array(boxes, dtype=np.float64).reshape(-1, 4)
