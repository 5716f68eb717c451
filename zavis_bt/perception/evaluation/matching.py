"""Which detection found which thing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.evaluation.tables import Table
from zavis_bt.types import FloatArray

LEAST_IOU = 0.5  # a detection has found a thing if they overlap by more


@dataclass(frozen=True, slots=True)
class Pairs:
    """Every detection with every thing of its image that it touches; sorted by detection."""

    detection: NDArray[np.intp]
    truth: NDArray[np.intp]
    iou: FloatArray

    def where(self, mask: NDArray[np.bool_]) -> Pairs:
        """Return some of the pairs."""
        return Pairs(self.detection[mask], self.truth[mask], self.iou[mask])


@dataclass(frozen=True, slots=True)
class Verdicts:
    """What each detection is, judged as Pascal VOC does it."""

    right: NDArray[np.bool_]
    """The first, best-scored one to find its thing, with the right label."""
    dropped: NDArray[np.bool_]
    """The thing of its label that it overlaps most is to be ignored: neither right nor wrong."""
    open_error: NDArray[np.bool_]
    """It has a known label but overlaps a thing of unknown class."""
    order: NDArray[np.intp]
    """Detections by falling score; equal ones as they were given."""


def overlaps(detections: Table, truths: Table) -> Pairs:
    """Return all pairs of detection and thing that have some area in common. ``truths`` are sorted by image."""
    first = np.searchsorted(truths.image, detections.image, side="left")
    count = np.searchsorted(truths.image, detections.image, side="right") - first
    detection = np.repeat(np.arange(len(detections)), count)
    begin = np.cumsum(count) - count  # of each detection's run of pairs
    truth = np.arange(len(detection)) - np.repeat(begin - first, count)
    a, b = detections.box[detection], truths.box[truth]
    sides = np.minimum(a[:, 2:], b[:, 2:]) - np.maximum(a[:, :2], b[:, :2])
    common = np.prod(np.maximum(sides, 0.0), axis=1)
    union = _areas(detections.box)[detection] + _areas(truths.box)[truth] - common
    pairs = Pairs(detection, truth, common / np.maximum(union, np.finfo(np.float64).tiny))
    return pairs.where(common > 0)


def judge_detections(detections: Table, truths: Table, pairs: Pairs, unknown: int) -> Verdicts:
    """Return what each detection is; ``unknown`` is the number of the unknown class."""
    count = len(detections)
    order = np.argsort(-detections.score, kind="stable")
    found = _best(pairs.where(truths.label[pairs.truth] == detections.label[pairs.detection]), count)
    ignored = np.zeros(count, dtype=np.bool_)
    ignored[found >= 0] = truths.ignored[found[found >= 0]]
    right = np.zeros(count, dtype=np.bool_)
    claims = order[(found[order] >= 0) & ~ignored[order]]  # best score first: the first claim of a thing stands
    right[claims[np.unique(found[claims], return_index=True)[1]]] = True
    open_error = np.zeros(count, dtype=np.bool_)
    open_error[pairs.detection[(pairs.iou > LEAST_IOU) & truths.of(unknown)[pairs.truth]]] = True
    return Verdicts(right, ignored, open_error & (detections.label != unknown) & ~ignored, order)


def covered(truths: Table, pairs: Pairs) -> NDArray[np.bool_]:
    """Return which things are overlapped enough by a detection of whatever label."""
    mask = np.zeros(len(truths), dtype=np.bool_)
    mask[pairs.truth[pairs.iou > LEAST_IOU]] = True
    return mask


def _best(pairs: Pairs, count: int) -> NDArray[np.intp]:
    """Return, for each detection, the thing it overlaps most, or -1 if that is not enough."""
    found = np.full(count, -1, dtype=np.intp)
    good = pairs.where(pairs.iou > LEAST_IOU)
    ranked = np.lexsort((-good.truth, good.iou))  # the last one written stands: the best, of equals the first
    found[good.detection[ranked]] = good.truth[ranked]
    return found


def _areas(boxes: FloatArray) -> FloatArray:
    sides = np.maximum(boxes[:, 2:] - boxes[:, :2], 0.0)
    areas: FloatArray = sides[:, 0] * sides[:, 1]
    return areas
