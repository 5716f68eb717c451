"""Running a detector over a data set."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.evaluation.open_set import OpenSetResult, judge
from zavis_bt.perception.evaluation.tables import Prediction, truths_of
from zavis_bt.types import Box, Detection

Predict = Callable[[NDArray[np.uint8]], Sequence[Detection]]
"""Detects in one image (h, w, 3) RGB; boxes in that image's pixels."""


def collect(
    dataset: DetectionDataset,
    predict: Predict,
    *,
    indices: Iterable[int] | None = None,
    width: int | None = None,
    progress: Callable[[int], None] = lambda done: None,
) -> list[Prediction]:
    """Run a detector over a data set.

    Args:
        dataset: The images.
        predict: The detector.
        indices: Which images; all if not given.
        width: Scale images down to this width first; the boxes are scaled back.
        progress: Told how many images are done, after each.

    Returns:
        All detections, in pixels of the full images.

    Raises:
        InputError: An image cannot be read.
    """
    predictions: list[Prediction] = []
    for done, index in enumerate(range(len(dataset)) if indices is None else indices, start=1):
        rgb = dataset.image(index, width=width)
        full = dataset.size(index)
        x, y = full[0] / rgb.shape[1], full[1] / rgb.shape[0]
        for found in predict(rgb):
            box = Box(found.box.x0 * x, found.box.y0 * y, found.box.x1 * x, found.box.y1 * y)
            predictions.append(Prediction(index, box, found.label, found.score))
        progress(done)
    return predictions


def evaluate(
    dataset: DetectionDataset,
    predict: Predict,
    known: Sequence[str],
    *,
    indices: Sequence[int] | None = None,
    width: int | None = None,
    progress: Callable[[int], None] = lambda done: None,
) -> OpenSetResult:
    """Run a detector over a data set and judge it; arguments as for `collect` and `judge`.

    Raises:
        InputError: An image cannot be read, or the detector names a class that is not known.
    """
    chosen = range(len(dataset)) if indices is None else indices
    predictions = collect(dataset, predict, indices=chosen, width=width, progress=progress)
    return judge(predictions, truths_of(dataset, chosen), known, len(chosen))
