"""Which images and things are worth looking at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.evaluation.matching import Pairs, Verdicts, covered
from zavis_bt.perception.evaluation.open_set import precision_recall
from zavis_bt.perception.evaluation.tables import Prediction, Table, Truth
from zavis_bt.types import UNKNOWN_CLASS


@dataclass(frozen=True, slots=True)
class Cuts:
    """Least scores of the boxes that are shown, where precision and recall are in the best balance (F1)."""

    known: float
    unknown: float

    def show(self, prediction: Prediction) -> bool:
        """Return whether a detection is shown."""
        return prediction.score >= (self.unknown if prediction.label == UNKNOWN_CLASS else self.known)


@dataclass(frozen=True, slots=True)
class Confusion:
    """A detection with a known label on a thing of unknown class."""

    prediction: Prediction
    truth: Truth


def best_cuts(detections: Table, truths: Table, verdicts: Verdicts, unknown: int) -> Cuts:
    """Return the cuts with the best F1, one for all known classes together, one for unknown ones."""
    return Cuts(*(_best_cut(detections, truths, verdicts, unknown, known) for known in (True, False)))


def spread(indices: Sequence[int], count: int) -> list[int]:
    """Return so many of the indices, at even distances."""
    if not indices:
        return []
    places = np.linspace(0, len(indices) - 1, min(count, len(indices))).round().astype(int)
    return [indices[place] for place in places]


def worst_misses(truths: Table, pairs: Pairs, given: Sequence[Truth], count: int) -> list[Truth]:
    """Return the largest things that no box covers; ``given`` are the things of the table, in its order."""
    box = truths.box
    areas = (box[:, 2] - box[:, 0]) * (box[:, 3] - box[:, 1])
    missed = np.flatnonzero(~covered(truths, pairs) & ~truths.ignored)
    return [given[k] for k in missed[np.argsort(-areas[missed], kind="stable")][:count]]


def worst_confusions(
    verdicts: Verdicts,
    pairs: Pairs,
    given: Sequence[Prediction],
    things: Sequence[Truth],
    unknown: NDArray[np.bool_],
    count: int,
) -> list[Confusion]:
    """Return the most confident wrong detections with a known label on things of unknown class, each thing once.

    Args:
        verdicts: On the detections.
        pairs: What overlaps what.
        given: The detections, in the order of their table.
        things: The things, in the order of their table.
        unknown: (n,) which things are of unknown class and count.
        count: At most so many.
    """
    wrong = verdicts.open_error & ~verdicts.right
    strange = pairs.where(unknown[pairs.truth])
    found: dict[int, Confusion] = {}
    for k in verdicts.order[wrong[verdicts.order]]:
        begin, end = np.searchsorted(strange.detection, [k, k + 1])
        nearest = int(strange.truth[begin + int(np.argmax(strange.iou[begin:end]))])
        found.setdefault(nearest, Confusion(given[k], things[nearest]))
        if len(found) == count:
            break
    return list(found.values())


def _best_cut(detections: Table, truths: Table, verdicts: Verdicts, unknown: int, known: bool) -> float:
    merged = np.where((detections.label < unknown) == known, 0, 1)
    things = np.where((truths.label < unknown) == known, 0, 1)
    recall, precision = precision_recall(
        Table(detections.image, detections.box, merged, detections.score, detections.ignored),
        Table(truths.image, truths.box, things, truths.score, truths.ignored),
        verdicts,
        0,
    )
    if not len(recall):
        return 0.0
    balance = 2 * recall * precision / np.maximum(recall + precision, 1e-9)
    ranked = verdicts.order[(merged[verdicts.order] == 0) & ~verdicts.dropped[verdicts.order]]
    return float(detections.score[ranked[int(np.argmax(balance))]])
