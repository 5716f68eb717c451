"""Average precision of the known classes."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.perception.evaluation.tables import Table
from zavis_bt.types import FloatArray

if TYPE_CHECKING:
    from torch import Tensor


def average_precisions(detections: Table, truths: Table, known: int) -> FloatArray:
    """Return the average precision at IoU 0.5 of each known class, (known,); NaN for a class that nothing shows.

    Args:
        detections: Those labelled unknown do not count.
        truths: Those of unknown class do not count; ignored ones are COCO's crowds.
        known: Number of known classes.

    Raises:
        InputError: torchmetrics is not installed.
    """
    try:
        from torchmetrics.detection import MeanAveragePrecision
    except ImportError as error:
        raise InputError("K-mAP: needs torchmetrics and pycocotools (pip install 'zavis_bt[neural]')") from error

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Encountered more than", UserWarning)  # than 100 detections in one image
        # The summary by class of `class_metrics` costs one more pass for each class; the curves hold the same.
        metric = MeanAveragePrecision(iou_thresholds=[0.5], extended_summary=True)
        ours, theirs = _of_known(detections, known), _of_known(truths, known)
        images = np.unique(np.concatenate([ours.image, theirs.image]))
        for image in images:
            metric.update([_prediction(ours, image)], [_target(theirs, image)])
        return _by_class(metric.compute(), theirs, known) if len(theirs) else np.full(known, np.nan)


def _by_class(answer: dict[str, Tensor], truths: Table, known: int) -> FloatArray:
    # Axes: threshold of IoU, recall, class, area (all first), most detections in an image (100 last).
    curves = answer["precision"].numpy()[0, :, :, 0, -1]
    precisions = np.full(known, np.nan)
    precisions[np.atleast_1d(answer["classes"].numpy())] = curves.mean(axis=0)
    shown = np.isin(np.arange(known), truths.label[~truths.ignored])
    return np.where(shown, precisions, np.nan)


def _of_known(table: Table, known: int) -> Table:
    rows = np.flatnonzero(table.label < known)
    rows = rows[np.argsort(table.image[rows], kind="stable")]
    return Table(table.image[rows], table.box[rows], table.label[rows], table.score[rows], table.ignored[rows])


def _prediction(table: Table, image: int) -> dict[str, Tensor]:
    import torch

    rows = _rows(table, image)
    return {
        "boxes": torch.from_numpy(table.box[rows]).float(),
        "scores": torch.from_numpy(table.score[rows]).float(),
        "labels": torch.from_numpy(table.label[rows]),
    }


def _target(table: Table, image: int) -> dict[str, Tensor]:
    import torch

    rows = _rows(table, image)
    return {
        "boxes": torch.from_numpy(table.box[rows]).float(),
        "labels": torch.from_numpy(table.label[rows]),
        "iscrowd": torch.from_numpy(table.ignored[rows].astype(np.int64)),
    }


def _rows(table: Table, image: int) -> slice:
    begin, end = np.searchsorted(table.image, [image, image + 1])
    return slice(int(begin), int(end))
