from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from zavis_bt.errors import InputError
from zavis_bt.perception import Eyes, Thresholds
from zavis_bt.perception.calibrating import calibrate, calibrated
from zavis_bt.perception.datasets import Annotation
from zavis_bt.perception.looking import Look, look_at, what_it_shows
from zavis_bt.types import UNKNOWN_CLASS, Box, Detection, FloatArray, RgbdFrame

BOX = Box(10, 10, 50, 50)
TEXTS = ["mug", "desk", "bed", "sofa"]
LANDMARKS = ("desk", "bed")


class OnePicture:
    """A data set of the same picture over and over."""

    name, categories, rendered = "scripted", tuple(TEXTS), True

    def __init__(self, *annotations: Annotation, count: int = 40) -> None:
        self._annotations, self._count = annotations, count

    def __len__(self) -> int:
        return self._count

    def image(self, index: int, *, width: int | None = None) -> NDArray[np.uint8]:
        return np.full((60, 80, 3), index, dtype=np.uint8)

    def annotations(self, index: int) -> tuple[Annotation, ...]:
        return self._annotations

    def size(self, index: int) -> tuple[int, int]:
        return 80, 60

    def path(self, index: int) -> str:
        return f"{index}.png"


class Found:
    def __init__(self, *detections: Detection) -> None:
        self._detections = detections

    def detect(self, frame: RgbdFrame) -> tuple[Detection, ...]:
        return self._detections


class Scores:
    """A matcher whose every box gets the same row, plus the frame's number."""

    def __init__(self, *row: float) -> None:
        self._row = row

    def match(self, frame: RgbdFrame, boxes: list[Box], texts: list[str]) -> FloatArray:
        return np.tile(self._row, (len(boxes), 1)) + frame.rgb[0, 0, 0] / 100


def test_box_shows_what_it_overlaps_by_half() -> None:
    annotations = [Annotation(BOX, "mug"), Annotation(Box(60, 0, 80, 20), "desk", ignored=True)]
    assert what_it_shows(BOX, annotations) == ("mug", True)
    assert what_it_shows(Box(10, 10, 50, 26), annotations) == ("mug", False)
    assert what_it_shows(Box(10, 10, 50, 20), annotations) == (None, True)
    assert what_it_shows(Box(60, 0, 80, 20), annotations) == ("desk", False)
    assert what_it_shows(BOX, []) == (None, True)


def test_texts_are_matched_with_the_boxes_that_a_mission_would_match() -> None:
    images = OnePicture(Annotation(BOX, "sofa"), Annotation(Box(60, 0, 80, 20), "mug"), count=1)
    found = Found(
        Detection(BOX, "sofa", 0.9),
        Detection(Box(60, 0, 80, 20), UNKNOWN_CLASS, 0.5),
        Detection(BOX, UNKNOWN_CLASS, 0.1),
    )
    eyes = Eyes(found, Scores(1, 2, 3, 4))
    (seen,) = look_at(eyes, images, [0], TEXTS)
    assert seen.labels == ("sofa", UNKNOWN_CLASS, UNKNOWN_CLASS)
    seen = seen.without_faint(Thresholds(detection=0.2))
    assert seen.shows == ("sofa", "mug")
    assert seen.scores.tolist() == [[1, 2, 3, 4]] * 2
    assert seen.named.tolist() == [[False, False, False, True], [False] * 4]
    assert seen.matched(Thresholds()).tolist() == [[False, False, False, True], [True] * 4]
    assert seen.matched(Thresholds(known=0.95)).all()
    assert seen.labels == ("sofa", UNKNOWN_CLASS)
    assert seen.confidence.tolist() == [0.9, 0.5]
    assert seen.present == {"sofa", "mug"}


def looks(count: int, *rows: tuple[str | None, list[float]], spread: float = 0.0) -> list[Look]:
    rng = np.random.default_rng(0)
    shows = tuple(show for show, _ in rows)
    scores = np.array([row for _, row in rows])
    present = frozenset(show for show in shows if show)
    noisy = (scores + spread * rng.standard_normal(scores.shape) for _ in range(count))
    return [look(shows, each, present) for each in noisy]


def look(shows: tuple[str | None, ...], scores: FloatArray, present: frozenset[str] = frozenset()) -> Look:
    no_class, labels = np.zeros(scores.shape, dtype=np.bool_), (UNKNOWN_CLASS,) * len(shows)
    return Look(shows, scores, no_class, labels, np.full(len(shows), 0.5), present)


def test_match_threshold_is_the_quantile_of_what_is_not_there() -> None:
    seen = looks(200, ("mug", [30, 10, 10, 10]), ("desk", [10, 28, 14, 5]), spread=1.0)
    found = calibrate(seen, TEXTS, LANDMARKS, false_alarms=0.02)
    alarms = (found.wrong >= found.thresholds.match - 0.005).mean()
    assert alarms == pytest.approx(0.02, abs=0.003)
    assert found.recall == 1.0
    assert 14 < found.thresholds.match < 18


def test_landmark_threshold_lets_one_other_box_in_fifty_pass() -> None:
    found = calibrate(looks(100, ("mug", [30, 20, 18, 10]), ("desk", [10, 28, 14, 5]), spread=0.5), TEXTS, LANDMARKS)
    assert 20 < found.thresholds.landmark < 23
    assert found.landmark_recall == pytest.approx(1.0)
    assert found.landmark_false == pytest.approx(0.02)
    assert found.landmark_accuracy == 1.0
    assert found.landmarks == 100


def test_temperature_is_the_one_that_scores_were_drawn_with() -> None:
    rng = np.random.default_rng(1)
    scores = rng.normal(20, 3, (4000, 2))
    odds = np.exp(scores / 2.5)
    first = rng.random(4000) < odds[:, 0] / odds.sum(axis=1)
    drawn = [
        look(("desk" if one else "bed",), np.array([[5.0, *row, 5.0]]), frozenset({"desk", "bed"}))
        for one, row in zip(first.tolist(), scores.tolist(), strict=True)
    ]
    assert calibrate(drawn, TEXTS, LANDMARKS).thresholds.temperature == pytest.approx(2.5, rel=0.1)


def test_images_without_boxes_count_as_quiet() -> None:
    empty = [look((), np.empty((0, 4)))] * 9900
    found = calibrate([*looks(100, ("desk", [10, 28, 14, 5]), spread=1.0), *empty], TEXTS, LANDMARKS)
    assert found.thresholds.match == pytest.approx(found.right.min(), abs=0.005)


def test_too_little_to_tell_is_refused() -> None:
    with pytest.raises(InputError, match=r"calibrate: only 0 boxes around what is annotated \(at least 30"):
        calibrate([], TEXTS, LANDMARKS)
    with pytest.raises(InputError, match=r"only 0 unknown boxes around landmarks \(desk, bed\)"):
        calibrate(looks(40, ("mug", [30, 20, 18, 10])), TEXTS, LANDMARKS)


def test_whole_calibration_leaves_known_landmarks_out() -> None:
    images = OnePicture(Annotation(BOX, "desk"), Annotation(Box(60, 0, 80, 20), "mug"))
    found = Found(Detection(BOX, UNKNOWN_CLASS, 0.9), Detection(Box(60, 0, 80, 20), UNKNOWN_CLASS, 0.5))
    done: list[tuple[int, int]] = []
    eyes = Eyes(found, Scores(20, 25, 5, 4), classes=("sofa",))
    result = calibrated(eyes, images, ("sofa", "desk"), count=40, progress=lambda *step: done.append(step))
    assert result.landmarks == 40
    assert result.images == 40
    assert done[-1] == (40, 40)


def test_relative_scores_forgive_a_crop_that_likes_every_text() -> None:
    rng = np.random.default_rng(2)
    seen = []
    for liking in rng.normal(0, 20, 300).tolist():
        scores = np.array([[30.0, 10, 10, 10], [10, 28, 14, 5]]) + liking
        seen.append(look(("mug", "desk"), scores, frozenset({"mug", "desk"})))
    plain = calibrate(seen, TEXTS, LANDMARKS, relative=False)
    relative = calibrate(seen, TEXTS, LANDMARKS)
    assert plain.recall < 0.5
    assert relative.recall == 1.0
    assert relative.contrast is not None
    assert relative.contrast.texts == tuple(TEXTS)
    assert relative.thresholds.temperature == plain.thresholds.temperature


def test_plain_scores_are_kept_where_relative_ones_help_little() -> None:
    seen = looks(100, ("mug", [30, 10, 10, 10]), ("desk", [10, 28, 14, 5]), spread=1.0)
    assert calibrate(seen, TEXTS, LANDMARKS).contrast is None
    assert calibrate(seen, TEXTS, LANDMARKS, relative=True).contrast is not None


def test_known_landmarks_need_the_confidence_that_sets_right_ones_apart() -> None:
    seen = looks(40, ("mug", [30, 10, 10, 10]), ("desk", [10, 28, 14, 5]))
    for confidence, shown in ((0.9, "sofa"), (0.8, "sofa"), (0.3, "bed"), (0.2, None)):
        known = replace(looks(1, (shown, [9, 9, 9, 9]))[0], labels=("sofa",), confidence=np.array([confidence]))
        seen += [known] * 20
    assert calibrate(seen, TEXTS, LANDMARKS).thresholds.known == pytest.approx(0.8)


def with_noise(count: int = 60) -> list[Look]:
    """Return looks at a mug and a desk, each with a faint box of nothing that looks like all there is."""
    seen = looks(count, ("mug", [30, 10, 10, 10]), ("desk", [10, 28, 14, 5]), spread=1.0)
    noise = looks(count, (None, [35, 35, 35, 35]), spread=1.0)
    return [
        Look(
            (*a.shows, *b.shows),
            np.concatenate((a.scores, b.scores)),
            np.concatenate((a.named, b.named)),
            (*a.labels, *b.labels),
            np.array([0.9, 0.8, 0.25]),
            a.present,
        )
        for a, b in zip(seen, noise, strict=True)
    ]


def test_faint_boxes_are_left_out_where_they_are_false_landmarks() -> None:
    found = calibrate(with_noise(), TEXTS, LANDMARKS, relative=False)
    assert 0.25 < found.thresholds.detection <= 0.8
    assert found.landmark_recall > 0.9
    assert calibrate(with_noise(), TEXTS, LANDMARKS, detection=0.0, relative=False).landmark_recall < 0.1


def test_confidence_counts_where_faint_boxes_score_high() -> None:
    found = calibrate(with_noise(), TEXTS, LANDMARKS, detection=0.0, relative=False)
    assert found.thresholds.trust > 0
    assert found.recall > 0.9
    even = looks(60, ("mug", [30, 10, 10, 10]), ("desk", [10, 28, 14, 5]), spread=1.0)
    assert calibrate(even, TEXTS, LANDMARKS, relative=False).thresholds.trust == 0


def test_known_landmarks_names_count_only_with_boxes_of_unsure_class() -> None:
    desk = looks(40, ("desk", [10, 28, 14, 35]))  # looks rather like a sofa
    sofas = [
        replace(each, labels=("sofa",), confidence=np.array([confidence]))
        for shown, count, confidence in (("sofa", 40, 0.9), ("sofa", 40, 0.3), (None, 80, 0.4))
        for each in looks(count, (shown, [10, 14, 14, 36]))
    ]
    for known, right in (((), 0.5), (("sofa",), 1.0)):
        found = calibrate([*desk, *sofas], TEXTS, (*LANDMARKS, "sofa"), known, relative=False)
        assert found.landmark_accuracy == right
