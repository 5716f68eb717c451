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
        predictions += predictions_of(index, predict(rgb), rgb, dataset.size(index))
        progress(done)
    return predictions


def predictions_of(
    image: int, found: Sequence[Detection], rgb: NDArray[np.uint8], size: tuple[int, int]
) -> list[Prediction]:
    """Return detections in an image (h, w, 3) that was scaled down, in pixels of the full one, which has that size."""
    x, y = size[0] / rgb.shape[1], size[1] / rgb.shape[0]
    boxes = [Box(one.box.x0 * x, one.box.y0 * y, one.box.x1 * x, one.box.y1 * y) for one in found]
    return [Prediction(image, box, one.label, one.score) for box, one in zip(boxes, found, strict=True)]


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
