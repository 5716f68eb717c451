"""Measuring thresholds: what a model scores where the truth is known.

Eyes look at labelled images as they would in a mission.

- m_t: a text that nothing in the image answers to shall bring a candidate in at most a given share of the images.
- The landmarks' threshold lets one in fifty of the boxes pass that are told by matching and show no landmark.
- The trust in the detector's confidence is the one with which the first candidate of an image is most often right.
- Scores may be relative to those of other texts (`Contrast`), which helps some models much and others not at all. The
  texts are the categories of the data, and T makes softmax(m / T) over them the likeliest for what boxes show.
- The least confidence of a known landmark sets boxes that show their class apart from those that do not, by
  the greatest sum of both shares told rightly (Youden's index).
- The least confidence of an ``unknown`` box is the one with which most things are their name's first candidate and most
  landmarks are told: faint boxes are false alarms more often than finds, and drive the other thresholds up.
- T_o makes softmax(m / T_o) over the landmarks' names the likeliest for such furniture.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError
from zavis_bt.perception.calibration import Thresholds
from zavis_bt.perception.contrast import Contrast
from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.eyes import Eyes
from zavis_bt.perception.looking import Look, look_at
from zavis_bt.perception.naming import key
from zavis_bt.types import UNKNOWN_CLASS, FloatArray

_MUCH = 0.05  # share of right pairs
_FALSE_LANDMARKS = 0.02  # share of the boxes that show none
_LEAST_PAIRS = 30  # from which a threshold means something
_TRUSTS = (0.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0)
_CONFIDENCES = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
_TEMPERATURES = np.geomspace(0.05, 50.0, 241)


@dataclass(frozen=True, slots=True)
class Calibration:
    """Thresholds, and how well they do on the images they are measured on."""

    thresholds: Thresholds
    contrast: Contrast | None
    right: FloatArray
    """Scores of boxes with the name of what they show."""
    wrong: FloatArray
    """Highest scores in an image of names that nothing in it answers to."""
    recall: float
    """Share of the right pairs that reach m_t."""
    first: int
    """Names of what an image shows that bring it as their first candidate, over all images."""
    landmark_recall: float
    """Share of landmarks' boxes that reach the landmarks' threshold."""
    landmark_false: float
    """Share of other boxes that do."""
    landmark_accuracy: float
    """Share of landmarks' boxes whose best name is right."""
    landmarks: int
    """Boxes of landmarks."""
    boxes: int
    images: int


def calibrate(
    looks: Sequence[Look],
    texts: Sequence[str],
    landmarks: Sequence[str],
    known: Sequence[str] = (),
    *,
    false_alarms: float = 0.05,
    detection: float | None = None,
    relative: bool | None = None,
) -> Calibration:
    """Return the thresholds that suit what eyes made of images.

    Args:
        looks: What they made of them.
        texts: What the boxes were matched with.
        landmarks: Names of landmarks; those that are no texts are left out.
        known: Those of them that are classes of the detector: only boxes that it is not sure of are matched with them.
        false_alarms: Share of images in which a text that nothing answers to may bring a candidate, 0 to 1.
        detection: Confidence below which ``unknown`` boxes are not looked at; None for the best.
        relative: Whether scores are to be relative to those of all texts; None for whichever tells much more, the
            paper's plain scores if in doubt.

    Raises:
        InputError: The images show too little to tell.
    """
    settle = partial(calibrate, looks, texts, landmarks, known, false_alarms=false_alarms)
    if relative is None:
        plain, other = (settle(detection=detection, relative=choice) for choice in (False, True))
        return other if other.recall > plain.recall + _MUCH else plain
    if detection is None:
        return _best(partial(settle, relative=relative))
    looks = [look.without_faint(Thresholds(detection=detection)) for look in looks]
    contrast = _contrast(looks, texts) if relative else None
    if contrast is not None:
        looks = [replace(look, scores=contrast.apply(look.scores, look.scores)) for look in looks]
    first = Thresholds(detection=detection, known=round(_sure_of_known(looks), 3))
    pairs = _Pairs(looks, texts, first)
    tried = [_as_candidates(pairs, replace(first, trust=trust), false_alarms) for trust in _TRUSTS]
    first = max(tried, key=pairs.told_first)
    right, wrong = pairs.right(first), pairs.wrong(first)
    names = [text for text in texts if key(text) in {key(name) for name in landmarks}]
    rows, truth = _landmark_rows(looks, texts, names, known, first)
    is_landmark = truth >= 0
    _need(int(is_landmark.sum()), "unknown boxes around landmarks" + (f" ({', '.join(names)})" if names else ""))
    best, told, others = rows.max(axis=1), rows[is_landmark], rows[~is_landmark].max(axis=1)
    landmark = float(np.quantile(others, 1 - _FALSE_LANDMARKS) if len(others) else best.min())
    temperature = _temperature(told, truth[is_landmark])
    return Calibration(
        replace(first, landmark=round(landmark, 2), temperature=round(temperature, 3)),
        contrast,
        right,
        wrong,
        recall=float((right >= first.match).mean()),
        first=pairs.told_first(first),
        landmark_recall=float((best[is_landmark] >= landmark).mean()),
        landmark_false=float((others >= landmark).mean()) if len(others) else 0.0,
        landmark_accuracy=float((told.argmax(axis=1) == truth[is_landmark]).mean()),
        landmarks=int(is_landmark.sum()),
        boxes=sum(len(look.shows) for look in looks),
        images=len(looks),
    )


def _best(settle: Callable[..., Calibration]) -> Calibration:
    """Return the calibration with the least confidence of ``unknown`` boxes that tells most."""
    found = [settle(detection=0.0)]
    for least in _CONFIDENCES:
        with contextlib.suppress(InputError):  # too few boxes are left to tell
            found.append(settle(detection=least))
    return max(found, key=_told)


def _told(found: Calibration) -> float:
    """Return how many things are the first candidate for their name, and how many landmarks pass."""
    return found.first + found.landmark_recall * found.landmarks


def _contrast(looks: Sequence[Look], texts: Sequence[str]) -> Contrast:
    """Return the contrast with all texts at the likeliest temperature."""
    rows, truth = [np.empty((0, len(texts)))], []
    for look in looks:
        named = [k for k, shown in enumerate(look.shows) if shown in texts]
        rows.append(look.scores[named])
        truth += [texts.index(look.shows[k] or "") for k in named]
    _need(len(truth), "boxes around what is annotated")
    return Contrast(tuple(texts), round(_temperature(np.concatenate(rows), np.array(truth, dtype=np.intp)), 3))


def _need(count: int, what: str) -> None:
    if count < _LEAST_PAIRS:
        raise InputError(f"calibrate: only {count} {what} (at least {_LEAST_PAIRS}: more images, or a better detector)")


def _as_candidates(pairs: _Pairs, thresholds: Thresholds, false_alarms: float) -> Thresholds:
    """Return the thresholds with the m_t that suits them."""
    right, wrong = pairs.right(thresholds), pairs.wrong(thresholds)
    _need(len(right), "boxes around what is annotated")
    match = float(np.quantile(wrong, 1 - false_alarms, method="higher"))
    if not np.isfinite(match):  # rarer than asked for, even if every box of another thing were a candidate
        match = float(right.min())
    return replace(thresholds, match=round(match, 2))


class _Pairs:
    """Boxes of all images and texts, as far as the two are matched."""

    def __init__(self, looks: Sequence[Look], texts: Sequence[str], thresholds: Thresholds) -> None:
        number = {text: column for column, text in enumerate(texts)}
        matched = np.concatenate([np.empty((0, len(texts)), dtype=np.bool_), *(x.matched(thresholds) for x in looks)])
        scores = np.concatenate([np.empty((0, len(texts))), *(look.scores for look in looks)])
        self._scores = np.where(matched, scores, -np.inf)
        self._confidence = np.concatenate([np.empty(0), *(look.confidence for look in looks)])
        self._image = np.repeat(np.arange(len(looks)), [len(look.shows) for look in looks])
        shown = np.array([number.get(name or "", -1) for look in looks for name in look.shows], dtype=np.intp)
        rows = np.flatnonzero(shown >= 0)
        rows = rows[matched[rows, shown[rows]]]
        self._right = rows, shown[rows]
        absent = [[text not in look.present for text in texts] for look in looks]
        self._absent = np.array(absent, dtype=np.bool_).reshape(-1, len(texts))

    def right(self, thresholds: Thresholds) -> FloatArray:
        """Return the scores of boxes with the name of what they show."""
        rows, columns = self._right
        return thresholds.candidate_scores(self._scores[rows, columns], self._confidence[rows])

    def told_first(self, thresholds: Thresholds) -> int:
        """Return how many names of what an image shows bring it as their first candidate."""
        scores = thresholds.candidate_scores(self._scores, self._confidence)
        rows, columns = self._right
        best = np.full(self._absent.shape, -np.inf)
        np.maximum.at(best, self._image, scores)
        first = scores[rows, columns] >= np.maximum(best[self._image[rows], columns], thresholds.match)
        return len(np.unique(np.stack((self._image[rows], columns), axis=1)[first], axis=0))

    def wrong(self, thresholds: Thresholds) -> FloatArray:
        """Return the highest score of each text that nothing in an image answers to; -inf without a box."""
        best = np.full(self._absent.shape, -np.inf)
        np.maximum.at(best, self._image, thresholds.candidate_scores(self._scores, self._confidence))
        return np.asarray(best[self._absent])


def _landmark_rows(
    looks: Sequence[Look], texts: Sequence[str], names: list[str], known: Sequence[str], thresholds: Thresholds
) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return the scores (n, m) of boxes told by matching with the landmarks' names, and the index of the right or -1.

    The names of known landmarks have -inf with boxes that the detector calls ``unknown``.
    """
    classes = {key(name) for name in known}
    columns, hidden = [texts.index(name) for name in names], [key(name) in classes for name in names]
    told = [
        (look.scores[k, columns], label == UNKNOWN_CLASS, shown)
        for look in looks
        for k, (shown, label) in enumerate(zip(look.shows, look.labels, strict=True))
        if columns and thresholds.is_unknown(label, float(look.confidence[k]))
    ]
    rows = np.concatenate([np.empty((0, len(columns))), *(row[None] for row, _, _ in told)])
    unnamed = np.array([is_unnamed for _, is_unnamed, _ in told], dtype=np.bool_)
    rows[unnamed[:, None] & np.array(hidden, dtype=np.bool_)] = -np.inf
    truth = np.array([names.index(shown) if shown in names else -1 for _, _, shown in told], dtype=np.intp)
    truth[np.isneginf(rows[np.arange(len(truth)), truth])] = -1
    return rows, truth


def _sure_of_known(looks: Sequence[Look]) -> float:
    """Return the confidence that sets right boxes of known classes apart; 0 if the images hardly show any."""
    pairs = [
        (confidence, key(label) == key(shown or ""))
        for look in looks
        for confidence, label, shown in zip(look.confidence.tolist(), look.labels, look.shows, strict=True)
        if label != UNKNOWN_CLASS
    ]
    right = np.array([is_right for _, is_right in pairs], dtype=np.bool_)
    if right.sum() < _LEAST_PAIRS or right.all():
        return 0.0
    return _dividing(np.array([confidence for confidence, _ in pairs]), right)


def _dividing(scores: FloatArray, positive: NDArray[np.bool_]) -> float:
    """Return the score that sets the positives apart best."""
    order = np.argsort(-scores, kind="stable")
    hits, alarms = np.cumsum(positive[order]), np.cumsum(~positive[order])
    index = hits / max(hits[-1], 1) - alarms / max(alarms[-1], 1)
    return float(scores[order][int(index.argmax())])


def _temperature(scores: FloatArray, truth: NDArray[np.intp]) -> float:
    """Return the temperature at which the softmax of (n, m) scores is likeliest to give (n,) the truth."""

    def surprise(temperature: float) -> float:
        logits = (scores - scores.max(axis=1, keepdims=True)) / temperature
        return float((np.log(np.exp(logits).sum(axis=1)) - logits[np.arange(len(truth)), truth]).mean())

    return float(min(_TEMPERATURES, key=surprise))


def calibrated(
    eyes: Eyes,
    images: DetectionDataset,
    landmarks: Sequence[str],
    *,
    count: int = 400,
    false_alarms: float = 0.05,
    detection: float | None = None,
    relative: bool | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Calibration:
    """Look at labelled images and return the thresholds.

    Args:
        eyes: Detector and matcher.
        images: Labelled; texts are their categories.
        landmarks: Names of landmarks.
        count: At most so many images, evenly spread over the data set.
        false_alarms: Share of images in which a text that nothing answers to may bring a candidate, 0 to 1.
        detection: Confidence below which ``unknown`` boxes are not looked at; None for the best.
        relative: Whether scores are to be relative to those of the data's categories; None for the better.
        progress: Told how many images are done, of how many.

    Raises:
        InputError: The images show too little to tell, or an image cannot be read.
    """
    total = min(count, len(images))
    indices = np.unique(np.linspace(0, len(images) - 1, total).round().astype(int)).tolist() if total else []
    texts = list(images.categories)
    looks = []
    for look in look_at(eyes, images, indices, texts):
        looks.append(look)
        progress(len(looks), len(indices))
    return calibrate(
        looks, texts, landmarks, eyes.classes or (), false_alarms=false_alarms, detection=detection, relative=relative
    )
