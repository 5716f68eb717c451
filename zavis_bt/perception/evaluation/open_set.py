"""How well a detector finds known things and tells that it does not know others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.evaluation.average_precision import average_precisions
from zavis_bt.perception.evaluation.matching import Verdicts, judge_detections, overlaps
from zavis_bt.perception.evaluation.sizes import SizeRecall, recall_by_size
from zavis_bt.perception.evaluation.tables import Classes, Prediction, Table, Truth, prediction_table, truth_table
from zavis_bt.types import FloatArray

WI_RECALL = 0.8  # of each class, where the wilderness impact is taken


@dataclass(frozen=True, slots=True)
class ClassResult:
    """One known class."""

    name: str
    truths: int
    """Things of it that count."""
    detections: int
    average_precision: float
    """At IoU 0.5; NaN without things."""
    recall: float
    """Of all its detections; NaN without things."""
    precision: float
    """Of all its detections; NaN without any."""


@dataclass(frozen=True, slots=True)
class OpenSetResult:
    """Open-set detection, judged. What cannot be told is NaN: U-Recall without unknown things, for example."""

    images: int
    k_map: float
    """K-mAP@0.5: mean average precision of the known classes that are shown."""
    u_recall: float
    """Share of things of unknown class that a detection labelled unknown found."""
    u_precision: float
    """Share of detections labelled unknown that found a thing of unknown class."""
    wi: float
    """Wilderness impact (Dhamija 2020) at recall 0.8."""
    a_ose: int
    """Absolute open-set error: detections with a known label on things of unknown class."""
    unknown_truths: int
    unknown_detections: int
    per_class: tuple[ClassResult, ...]
    by_size: tuple[SizeRecall, ...]
    """Recall of whatever things by whatever labels."""

    def as_dict(self) -> dict[str, Any]:
        """Return plain values for JSON, with None for NaN."""
        return {name: _plain(value) for name, value in asdict(self).items()}


def judge(
    predictions: Sequence[Prediction], truths: Sequence[Truth], known: Sequence[str], images: int
) -> OpenSetResult:
    """Judge detections against ground truth.

    Things whose category is not among the known classes count as unknown. A thing is found once, by the best-scored
    detection of its label with IoU > 0.5; a detection whose thing is an ignored one is left out.

    Args:
        predictions: All detections, from whatever images.
        truths: All things in the same images.
        known: Names of the known classes.
        images: How many images there are.

    Raises:
        InputError: A label is neither a known class nor unknown.
    """
    classes = Classes(known)
    detections, things = prediction_table(predictions, classes), truth_table(truths, classes)
    pairs = overlaps(detections, things)
    verdicts = judge_detections(detections, things, pairs, classes.unknown)
    precisions = average_precisions(detections, things, classes.unknown)
    recall, precision = _rates(detections, things, verdicts, classes.unknown)
    return OpenSetResult(
        images=images,
        k_map=_mean(precisions[np.isfinite(precisions)]),
        u_recall=recall,
        u_precision=precision,
        wi=wilderness_impact(detections, things, verdicts, classes.unknown),
        a_ose=int(verdicts.open_error.sum()),
        unknown_truths=_count(things, classes.unknown),
        unknown_detections=int((detections.label == classes.unknown).sum()),
        per_class=tuple(
            ClassResult(
                name,
                _count(things, k),
                int((detections.label == k).sum()),
                float(precisions[k]),
                *_rates(detections, things, verdicts, k),
            )
            for k, name in enumerate(classes.names)
        ),
        by_size=recall_by_size(things, pairs),
    )


def wilderness_impact(
    detections: Table, truths: Table, verdicts: Verdicts, known: int, recall: float = WI_RECALL
) -> float:
    """Return the wilderness impact as Joseph et al. (ORE, 2021) compute it.

    Each class's ranked list is cut where its recall is closest to ``recall``. The result is the mean number of open-set
    errors above the cuts over the mean number of detections there; classes without things or detections are left out.
    """
    errors, totals = [], []
    for k in range(known):
        ranked = _ranked(detections, verdicts, k)
        count = _count(truths, k)
        if count == 0 or len(ranked) == 0:
            continue
        recalls = np.cumsum(verdicts.right[ranked]) / count
        cut = int(np.argmin(np.abs(recalls - recall))) + 1
        errors.append(int(verdicts.open_error[ranked[:cut]].sum()))
        totals.append(cut)
    return _mean(np.array(errors)) / _mean(np.array(totals)) if totals else math.nan


def precision_recall(detections: Table, truths: Table, verdicts: Verdicts, label: int) -> tuple[FloatArray, FloatArray]:
    """Return recall and precision, (n,) each, of the first 1, 2, … n detections of a label, best first."""
    ranked = _ranked(detections, verdicts, label)
    hits = np.cumsum(verdicts.right[ranked])
    return hits / max(_count(truths, label), 1), hits / np.arange(1, len(ranked) + 1)


def _ranked(detections: Table, verdicts: Verdicts, label: int) -> NDArray[np.intp]:
    order = verdicts.order
    ranked: NDArray[np.intp] = order[(detections.label[order] == label) & ~verdicts.dropped[order]]
    return ranked


def _rates(detections: Table, truths: Table, verdicts: Verdicts, label: int) -> tuple[float, float]:
    """Return recall and precision of all detections of a label."""
    counted = _ranked(detections, verdicts, label)
    hits, things = int(verdicts.right[counted].sum()), _count(truths, label)
    return (hits / things if things else math.nan), (hits / len(counted) if len(counted) else math.nan)


def _count(truths: Table, label: int) -> int:
    return int(truths.of(label).sum())


def _mean(values: NDArray[np.floating] | NDArray[np.integer]) -> float:
    return float(np.mean(values)) if len(values) else math.nan


def _plain(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {name: _plain(inner) for name, inner in value.items()}
    return [_plain(inner) for inner in value] if isinstance(value, list | tuple) else value
