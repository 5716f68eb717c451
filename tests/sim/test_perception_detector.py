from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from seen_worlds import look, piece, room, seen, thing

from sim.frame import SimFrame
from sim.perception import DetectorSettings, SimDetector
from sim.world import World
from zavis_bt.errors import InputError
from zavis_bt.protocols import Detector
from zavis_bt.types import UNKNOWN_CLASS, Box, CameraIntrinsics, RgbdFrame

NO_FALSE = DetectorSettings(false_positives=0.0)


def detector(
    seed: int = 0, settings: DetectorSettings = NO_FALSE, known: tuple[str, ...] = ("sofa", "bed")
) -> SimDetector:
    return SimDetector(known, np.random.default_rng(seed), settings)


def rate(world: Callable[[int], World], instance: str, seeds: int = 150, x: float = 1.0) -> float:
    """Share of detectors that find the instance in one frame."""
    hits = 0
    for seed in range(seeds):
        frame = look(world(seed), x, 2.0, stamp=float(seed))
        view = seen(frame, instance)
        assert view is not None
        hits += any(found.box.iou(view.box) > 0.3 for found in detector(seed).detect(frame))
    return hits / seeds


def test_it_is_a_detector():
    checked: Detector = detector()
    assert checked.detect(look(room(), 1.0, 2.0)) == []


def test_the_detection_rate_grows_with_size():
    def at(distance: float) -> float:
        world = room((), (thing("mug", 1.0 + distance, 2.0, 0.85),))
        return rate(lambda _: world, "mug_1")

    near, middle, far = at(0.6), at(2.0), at(4.5)  # 92, 28 and 12 px
    assert near == pytest.approx(0.9, abs=0.08)
    assert near > middle > far
    assert far < 0.5


def test_the_detection_rate_grows_with_the_visible_fraction():
    def behind(edge: float) -> float:
        screen = piece("shelf", 2.0, edge - 0.3, 2.0)
        world = room((screen,), (thing("box", 3.0, 2.0, 0.7),))
        return rate(lambda _: world, "box_1")

    free, half, slit = behind(1.8), behind(2.0), behind(2.05)
    assert free > half > slit


def test_what_is_not_in_sight_is_never_found():
    world = room((piece("dresser", 2.5, 2.0, 1.2),), (thing("mug", 3.0, 2.0, 0.8),))
    for seed in range(30):
        assert len(detector(seed).detect(look(world, 1.0, 2.0))) <= 1


def test_a_second_look_from_another_place_helps_more():
    world = room((), (thing("mug", 4.0, 2.0, 0.85),))
    same = other = 0
    for seed in range(400):
        judge = detector(seed)
        first, again, moved = (
            bool(judge.detect(look(world, x, 2.0, stamp=stamp))) for x, stamp in ((1.3, 0.0), (1.3, 1.0), (1.6, 2.0))
        )
        same += not first and again
        other += not first and moved
    assert other > same


def test_known_furniture_gets_its_class():
    world = room((piece("sofa", 3.0, 2.0, 0.8, size=1.2),))
    labels = [found.label for seed in range(200) for found in detector(seed).detect(look(world, 1.0, 2.0))]
    assert len(labels) > 150
    assert labels.count("sofa") / len(labels) == pytest.approx(0.9, abs=0.06)
    assert labels.count(UNKNOWN_CLASS) / len(labels) == pytest.approx(0.1, abs=0.06)


def test_class_probabilities_sum_to_one_and_name_the_label():
    world = room((piece("sofa", 3.0, 2.0, 0.8, size=1.2),))
    for seed in range(20):
        for found in detector(seed).detect(look(world, 1.0, 2.0)):
            if found.label != UNKNOWN_CLASS:
                assert sum(p for _, p in found.probabilities) == pytest.approx(1.0)
                assert max(found.probabilities, key=lambda pair: pair[1])[0] == found.label


def test_other_furniture_and_objects_are_unknown():
    world = room((piece("desk", 3.0, 2.0, 0.8, size=1.0),), (thing("box", 3.0, 2.0, 0.8, on="desk_1"),))
    labels = [found.label for seed in range(200) for found in detector(seed).detect(look(world, 1.0, 2.0))]
    assert labels.count(UNKNOWN_CLASS) / len(labels) > 0.95


def test_unknown_boxes_are_more_uncertain_than_known_ones():
    world = room((piece("sofa", 3.0, 1.4, 0.8, size=1.0), piece("desk", 3.0, 2.8, 0.8, size=1.0)))
    found = [found for seed in range(100) for found in detector(seed).detect(look(world, 1.0, 2.0))]
    total = {True: [], False: []}
    for one in found:
        total[one.label == UNKNOWN_CLASS].append(one.epistemic + one.aleatoric)
    assert np.mean(total[True]) > np.mean(total[False]) + 0.2


def test_far_furniture_is_too_small_a_part_of_the_image():
    world = room((piece("garbage can", 5.5, 2.0, 0.2, size=0.1),))
    assert all(detector(seed).detect(look(world, 1.0, 2.0)) == [] for seed in range(20))


def test_boxes_stay_close_to_the_truth_and_inside_the_image():
    world = room((piece("desk", 2.0, 2.6, 0.8, size=1.0),), (thing("cd", 2.0, 2.6, 0.8, on="desk_1"),))
    overlaps = []
    for seed in range(100):
        frame = look(world, 1.0, 2.0, tilt=-0.1)
        for found in detector(seed).detect(frame):
            assert 0 <= found.box.x0 < found.box.x1 <= 640
            assert 0 <= found.box.y0 < found.box.y1 <= 480
            assert min(found.box.x1 - found.box.x0, found.box.y1 - found.box.y0) >= 4.0 - 1e-9
            if found.box.area > 10000:
                overlaps.append(max(found.box.iou(view.box) for view in frame.instances))
    assert 0.75 < np.median(overlaps) < 0.97


def test_false_positives_come_at_their_rate_and_with_low_scores():
    settings = DetectorSettings(false_positives=1.2)
    counts, scores = [], []
    for seed in range(400):
        found = detector(seed, settings).detect(look(room(), 1.0, 2.0, stamp=float(seed)))
        counts.append(len(found))
        scores += [one.score for one in found]
    assert np.mean(counts) == pytest.approx(1.2, abs=0.15)
    assert np.mean(scores) < 0.4


def test_best_detections_come_first_and_scores_are_probabilities():
    world = room((piece("desk", 3.0, 2.0, 0.8, size=1.0), piece("bed", 3.5, 3.0, 0.6, size=1.5)))
    scores = [found.score for found in detector(1, DetectorSettings()).detect(look(world, 1.0, 2.0, tilt=-0.2))]
    assert scores == sorted(scores, reverse=True)
    assert all(0 < score < 1 for score in scores)


def test_the_order_of_frames_does_not_matter():
    world = room((piece("desk", 3.0, 2.0, 0.8),), (thing("mug", 3.0, 2.0, 0.8, on="desk_1"),))
    frames: list[SimFrame] = [look(world, 1.0, 2.0, stamp=float(k)) for k in range(6)]
    forwards, backwards = detector(3, DetectorSettings()), detector(3, DetectorSettings())
    one = [forwards.detect(frame) for frame in frames]
    two = [backwards.detect(frame) for frame in reversed(frames)]
    assert one == two[::-1]


def test_a_foreign_frame_is_refused():
    blank = np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4), np.float32)
    frame = RgbdFrame(CameraIntrinsics(4, 4, 4.0, 4.0, 2.0, 2.0), np.eye(4), 0.0, lambda: blank)
    with pytest.raises(InputError, match="only judge frames of the simulated camera"):
        detector().detect(frame)


def test_a_detector_that_knows_nothing_calls_everything_unknown():
    world = room((piece("sofa", 3.0, 2.0, 0.8, size=1.2),))
    found = [one for seed in range(20) for one in detector(seed, known=()).detect(look(world, 1.0, 2.0))]
    assert {one.label for one in found} == {UNKNOWN_CLASS}
    assert isinstance(found[0].box, Box)
