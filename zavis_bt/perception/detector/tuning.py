"""Setting a trained detector's cut of the uncertainty on labelled images, which are not to be those it is judged on."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.detector.neural_detector import NeuralDetector
from zavis_bt.perception.evaluation import OpenSetResult, Prediction, judge, predictions_of, truths_of

CUTS = (0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95)


@dataclass(frozen=True, slots=True)
class Cut:
    """What a detector reaches that takes for unknown what is more uncertain than so much of known things."""

    cdf: float
    """Of the total uncertainty's Gaussian."""
    result: OpenSetResult


def judge_cuts(
    detector: NeuralDetector,
    dataset: DetectionDataset,
    cuts: Sequence[float] = CUTS,
    *,
    images: int | None = None,
    progress: Callable[[int], None] = lambda done: None,
) -> list[Cut]:
    """Judge a detector at several cuts, with one look at each image.

    Args:
        detector: Which.
        dataset: The images.
        cuts: CDFs to try, 0 to 1.
        images: How many, from the first; all if not given.
        progress: Told how many are done.

    Raises:
        InputError: The detector's method has no such cut, or an image cannot be read.
    """
    config = detector.network.config
    if config.method != "zavis":
        raise InputError(f"tune: {config.method} has no cut of the uncertainty (a detector of the method zavis has)")
    choices = [replace(config.choice, cdf=cdf) for cdf in cuts]
    found: list[list[Prediction]] = [[] for _ in cuts]
    indices = range(min(images or len(dataset), len(dataset)))
    for index in indices:
        rgb = dataset.image(index, width=config.width)
        for predictions, seen in zip(found, detector.detect_by(rgb, choices), strict=True):
            predictions += predictions_of(index, seen, rgb, dataset.size(index))
        progress(index + 1)
    truths = truths_of(dataset, indices)
    results = (judge(predictions, truths, detector.classes, len(indices)) for predictions in found)
    return [Cut(cdf, result) for cdf, result in zip(cuts, results, strict=True)]


def best_cut(judged: Sequence[Cut], most_loss: float) -> Cut:
    """Return the cut of the least wilderness impact among those that lose at most so much of the best K-mAP.

    Raises:
        InputError: The images show too little to tell.
    """
    told = [cut for cut in judged if math.isfinite(cut.result.k_map) and math.isfinite(cut.result.wi)]
    if not told:
        raise InputError("tune: the wilderness impact cannot be told (images with more things, known and unknown)")
    most = max(cut.result.k_map for cut in told)
    return min((cut for cut in told if cut.result.k_map >= most - most_loss), key=lambda cut: cut.result.wi)
