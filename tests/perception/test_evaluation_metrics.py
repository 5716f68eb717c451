from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip("torchmetrics")

from zavis_bt.errors import InputError
from zavis_bt.perception.evaluation import Prediction, Truth, judge
from zavis_bt.types import Box

KNOWN = ("chair", "sofa")
HERE, THERE, FAR = Box(0, 0, 10, 10), Box(50, 50, 80, 90), Box(200, 0, 260, 30)


def said(label: str, box: Box, score: float, image: int = 0) -> Prediction:
    return Prediction(image, box, label, score)


def moved(box: Box, by: float) -> Box:
    return Box(box.x0 + by, box.y0, box.x1 + by, box.y1)


def test_perfect_detections_are_judged_perfect() -> None:
    truths = [Truth(0, HERE, "chair"), Truth(0, THERE, "kettle"), Truth(1, FAR, "sofa")]
    found = [said("chair", HERE, 0.9), said("unknown", THERE, 0.8), said("sofa", FAR, 0.7, 1)]
    result = judge(found, truths, KNOWN, 2)
    assert result.k_map == pytest.approx(1)
    assert (result.u_recall, result.u_precision, result.wi, result.a_ose) == (1, 1, 0, 0)
    assert [each.recall for each in result.per_class] == [1, 1]


def test_every_category_that_is_not_known_counts_as_unknown() -> None:
    truths = [Truth(0, box, name) for box, name in ((HERE, "kettle"), (THERE, "guitar"), (FAR, "chair"))]
    result = judge([said("unknown", HERE, 0.9)], truths, KNOWN, 1)
    assert result.unknown_truths == 2
    assert result.u_recall == 0.5


def test_spelling_of_classes_does_not_matter() -> None:
    result = judge([said("Dining Table", HERE, 0.9)], [Truth(0, HERE, "diningtable")], ["dining table"], 1)
    assert result.k_map == pytest.approx(1)
    assert result.unknown_truths == 0


def test_a_thing_is_found_once() -> None:
    found = [said("unknown", HERE, 0.9), said("unknown", moved(HERE, 1), 0.8), said("unknown", HERE, 0.7)]
    result = judge(found, [Truth(0, HERE, "kettle")], KNOWN, 1)
    assert result.u_recall == 1
    assert result.u_precision == pytest.approx(1 / 3)


def test_the_best_scored_detection_claims_its_thing_even_if_another_fits_better() -> None:
    found = [said("chair", HERE, 0.5), said("chair", moved(HERE, 2), 0.9)]
    result = judge(found, [Truth(0, HERE, "chair")], KNOWN, 1)
    assert result.k_map == pytest.approx(1)  # the wrong one comes after full recall


def test_a_detection_is_of_its_own_image() -> None:
    result = judge([said("unknown", HERE, 0.9, image=1)], [Truth(0, HERE, "kettle")], KNOWN, 2)
    assert (result.u_recall, result.u_precision) == (0, 0)


def test_half_an_overlap_is_not_enough() -> None:
    half = Box(0, 0, 10, 5)
    truths = [Truth(0, HERE, "kettle")]
    assert judge([said("unknown", half, 0.9)], truths, KNOWN, 1).u_recall == 0
    assert judge([said("unknown", Box(0, 0, 10, 5.1), 0.9)], truths, KNOWN, 1).u_recall == 1


def test_an_ignored_thing_neither_counts_nor_penalises() -> None:
    truths = [Truth(0, HERE, "kettle", ignored=True), Truth(0, THERE, "guitar")]
    truths += [Truth(0, FAR, "chair", ignored=True), Truth(1, HERE, "chair")]
    found = [said("unknown", HERE, 0.9), said("unknown", THERE, 0.8), said("chair", FAR, 0.9)]
    found += [said("chair", HERE, 0.5, 1)]
    result = judge(found, truths, KNOWN, 2)
    assert (result.u_recall, result.u_precision) == (1, 1)
    assert result.k_map == pytest.approx(1)
    assert result.per_class[0].truths == 1
    assert result.per_class[0].precision == 1


def test_a_known_name_on_an_ignored_unknown_thing_is_no_open_set_error() -> None:
    truths = [Truth(0, HERE, "kettle", ignored=True), Truth(0, THERE, "chair")]
    assert judge([said("chair", HERE, 0.9)], truths, KNOWN, 1).a_ose == 0


def test_open_set_errors_count_every_known_detection_on_an_unknown_thing() -> None:
    truths = [Truth(0, HERE, "kettle"), Truth(0, THERE, "chair")]
    found = [said("chair", HERE, 0.9), said("sofa", moved(HERE, 1), 0.2), said("unknown", HERE, 0.5)]
    found += [said("sofa", THERE, 0.9), said("sofa", FAR, 0.9)]  # wrong, but not open-set errors
    assert judge(found, truths, KNOWN, 1).a_ose == 2


def test_wilderness_impact_by_hand() -> None:
    # chair: 5 things. Ranked: right, open error, right, right, right (recall 0.8), open error, right.
    # sofa: 1 thing. Ranked: open error (recall 0), right (recall 1, closest to 0.8), wrong.
    places = [Box(100 * k, 0, 100 * k + 50, 50) for k in range(8)]
    truths = [Truth(0, box, "chair") for box in places[:5]]
    truths += [Truth(0, places[5], "sofa"), Truth(0, places[6], "kettle"), Truth(0, places[7], "guitar")]
    chairs = [places[0], places[6], places[1], places[2], places[3], places[7], places[4]]
    sofas = [places[6], places[5], Box(0, 300, 50, 350)]
    found = [said("chair", box, 1 - k / 10) for k, box in enumerate(chairs)]
    found += [said("sofa", box, 1 - k / 10) for k, box in enumerate(sofas)]
    result = judge(found, truths, KNOWN, 1)
    # Up to the cuts: chair 1 open error of 5, sofa 1 of 2.
    assert result.wi == pytest.approx(((1 + 1) / 2) / ((5 + 2) / 2))
    assert result.a_ose == 3


def test_wilderness_impact_takes_the_first_best_recall_where_0_8_is_never_reached() -> None:
    truths = [Truth(0, HERE, "chair"), Truth(0, THERE, "chair"), Truth(0, FAR, "kettle")]
    found = [said("chair", HERE, 0.9), said("chair", FAR, 0.8), said("chair", moved(FAR, 1), 0.7)]
    assert judge(found, truths, KNOWN, 1).wi == 0  # recall is 0.5 from the first detection on
    found[0], found[1] = said("chair", HERE, 0.8), said("chair", FAR, 0.9)
    assert judge(found, truths, KNOWN, 1).wi == 1 / 2


def test_equal_scores_keep_the_order_they_came_in() -> None:
    truths = [Truth(0, HERE, "chair"), Truth(0, FAR, "kettle")]
    right, strange = said("chair", HERE, 0.5), said("chair", FAR, 0.5)
    assert judge([right, strange], truths, KNOWN, 1).wi == 0
    assert judge([strange, right], truths, KNOWN, 1).wi == 1 / 2


def test_a_class_without_detections_counts_in_the_mean_precision_and_not_in_the_wilderness_impact() -> None:
    truths = [Truth(0, HERE, "chair"), Truth(0, THERE, "sofa"), Truth(0, FAR, "kettle")]
    result = judge([said("chair", HERE, 0.9)], truths, KNOWN, 1)
    assert result.k_map == pytest.approx(0.5)
    assert result.wi == 0
    assert result.per_class[1].recall == 0
    assert math.isnan(result.per_class[1].precision)


def test_a_class_that_nothing_shows_is_left_out() -> None:
    result = judge([said("chair", HERE, 0.9), said("sofa", THERE, 0.9)], [Truth(0, HERE, "chair")], KNOWN, 1)
    assert result.k_map == pytest.approx(1)
    assert math.isnan(result.per_class[1].average_precision)


def test_without_unknown_things_their_recall_cannot_be_told() -> None:
    result = judge([said("unknown", THERE, 0.9)], [Truth(0, HERE, "chair")], KNOWN, 1)
    assert math.isnan(result.u_recall)
    assert result.u_precision == 0
    assert result.as_dict()["u_recall"] is None


def test_a_detector_that_never_says_unknown_finds_none() -> None:
    truths = [Truth(0, HERE, "chair"), Truth(0, THERE, "kettle")]
    result = judge([said("chair", HERE, 0.9), said("sofa", THERE, 0.8)], truths, KNOWN, 1)
    assert result.u_recall == 0
    assert math.isnan(result.u_precision)
    assert result.a_ose == 1


def test_nothing_found_at_all() -> None:
    result = judge([], [Truth(0, HERE, "chair"), Truth(0, THERE, "kettle")], KNOWN, 1)
    assert (result.k_map, result.u_recall, result.a_ose) == (0, 0, 0)
    assert math.isnan(result.wi)


def test_nothing_there_at_all() -> None:
    result = judge([said("chair", HERE, 0.9)], [], KNOWN, 1)
    assert math.isnan(result.k_map)
    assert result.a_ose == 0


def test_recall_by_size_asks_for_no_label_and_no_class() -> None:
    truths = [Truth(0, HERE, "chair"), Truth(0, THERE, "kettle"), Truth(1, HERE, "cup")]
    result = judge([said("sofa", HERE, 0.1), said("chair", moved(THERE, 2), 0.1)], truths, KNOWN, 2)
    small, middle = result.by_size[0], next(size for size in result.by_size if size.least == 32)
    assert (small.truths, small.recall) == (2, 0.5)
    assert (middle.truths, middle.recall) == (1, 1.0)
    assert sum(size.truths for size in result.by_size) == 3


def test_the_order_of_images_and_boxes_does_not_matter() -> None:
    rng = np.random.default_rng(3)
    names = ["chair", "sofa", "kettle"]
    boxes = [Box(x, y, x + 40, y + 40) for x, y in rng.uniform(0, 200, (60, 2)).tolist()]
    truths = [Truth(k % 7, box, names[k % 3], k % 11 == 0) for k, box in enumerate(boxes)]
    scores = rng.permutation(60) / 60
    labels = ["chair", "sofa", "unknown"]
    found = [said(labels[rng.integers(3)], moved(t.box, 3), scores[k], t.image) for k, t in enumerate(truths)]
    first = judge(found, truths, KNOWN, 7)
    mixed = judge([found[k] for k in rng.permutation(60)], [truths[k] for k in rng.permutation(60)], KNOWN, 7)
    for name, value in first.as_dict().items():
        if isinstance(value, list):
            rows, mixed_rows = value, mixed.as_dict()[name]
            assert len(mixed_rows) == len(rows)
            for row, other in zip(rows, mixed_rows, strict=True):
                assert other == pytest.approx(row, nan_ok=True)
        else:
            assert mixed.as_dict()[name] == pytest.approx(value, nan_ok=True)


def test_average_precision_is_torchmetrics_own() -> None:
    torch = pytest.importorskip("torch")
    from torchmetrics.detection import MeanAveragePrecision

    rng = np.random.default_rng(4)
    metric = MeanAveragePrecision(iou_thresholds=[0.5])
    truths, found = [], []
    for image in range(8):
        corners = rng.uniform(0, 100, (6, 2))
        boxes, labels = np.hstack([corners, corners + 40]), rng.integers(0, 2, 6)
        shifted, scores = boxes + rng.normal(0, 8, (6, 1)), rng.random(6)
        truths += [Truth(image, Box(*box), KNOWN[k]) for box, k in zip(boxes.tolist(), labels, strict=True)]
        rows = zip(shifted.tolist(), labels, scores.tolist(), strict=True)
        found += [said(KNOWN[k], Box(*box), score, image) for box, k, score in rows]
        told = {
            "boxes": torch.from_numpy(shifted),
            "scores": torch.from_numpy(scores),
            "labels": torch.from_numpy(labels),
        }
        metric.update([told], [{"boxes": torch.from_numpy(boxes), "labels": torch.from_numpy(labels)}])
    assert judge(found, truths, KNOWN, 8).k_map == pytest.approx(float(metric.compute()["map"]), abs=1e-6)


def test_labels_that_nobody_knows_are_told() -> None:
    with pytest.raises(InputError, match=r"'chiar' is not one of the known classes \(did you mean 'chair'\?\)"):
        judge([said("chiar", HERE, 0.9)], [], KNOWN, 1)
    with pytest.raises(InputError, match="each once"):
        judge([], [], ["chair", "Chair"], 1)
