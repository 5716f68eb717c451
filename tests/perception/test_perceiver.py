from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from perception_scene import ScriptedDetector, ScriptedMatcher, box_around, frame_of, unknown

from zavis_bt.errors import InputError
from zavis_bt.perception import DEFAULT_KNOWN_LANDMARKS, DEFAULT_UNKNOWN_LANDMARKS, Perceiver, Thresholds
from zavis_bt.perception.perceiver import softmax
from zavis_bt.types import UNKNOWN_CLASS, Box, Candidate, Detection, Landmark, Percept, entropy

DESK = ((3.0, 0.1, 0.1), (3.6, 1.1, 0.75))
SOFA = ((3.5, -1.4, 0.1), (4.2, -0.2, 0.8))
MUG = ((3.05, 0.5, 0.75), (3.13, 0.58, 0.85))
FRAME = frame_of([DESK, SOFA, MUG], tilt=-0.1)
DESK_BOX, SOFA_BOX, MUG_BOX = (box_around(solid, FRAME) for solid in (DESK, SOFA, MUG))
NAMES = ("bed", "desk", "armchair")


def perceive(
    matcher: ScriptedMatcher,
    *detections: Detection,
    target: str = "mug",
    min_landmark_size: float = 0.25,
    **thresholds: float,
) -> Percept:
    perceiver = Perceiver(
        ScriptedDetector(*detections),
        matcher,
        known=("sofa",),
        unknown=NAMES,
        thresholds=Thresholds(**thresholds),
        min_landmark_size=min_landmark_size,
    )
    return perceiver.perceive(FRAME, target)


def sofa(box: Box = SOFA_BOX, score: float = 0.9) -> Detection:
    return Detection(box, "sofa", score, (("sofa", 0.6), ("chair", 0.2), ("dining table", 0.2)))


def test_unknown_box_gets_the_softmax_of_its_scores() -> None:
    scores = {"bed": 25.0, "desk": 27.0, "armchair": 24.0}
    percept = perceive(ScriptedMatcher({DESK_BOX: scores}), unknown(DESK_BOX))
    (sighting,) = percept.sightings
    weights = {name: math.exp(score) for name, score in scores.items()}
    expected = {name: weight / sum(weights.values()) for name, weight in weights.items()}
    assert dict(sighting.probabilities) == pytest.approx(expected)
    assert sighting.label == "desk"
    assert sighting.stamp == FRAME.stamp
    landmark = Landmark(0, sighting.probabilities, sighting.position, sighting.radius, 1)
    assert landmark.entropy == pytest.approx(-sum(p * math.log(p) for p in expected.values()))


def test_temperature_flattens_the_distribution() -> None:
    matcher = ScriptedMatcher({DESK_BOX: {"bed": 25.0, "desk": 27.0, "armchair": 24.0}})
    entropies = []
    for temperature in (0.5, 1.0, 4.0, 1e6):
        (sighting,) = perceive(matcher, unknown(DESK_BOX), temperature=temperature).sightings
        entropies.append(entropy(np.array([p for _, p in sighting.probabilities])))
    assert entropies == sorted(entropies)
    assert entropies[-1] == pytest.approx(math.log(3))


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=20))
def test_softmax_is_a_distribution_of_the_same_order(logits: list[float]) -> None:
    probabilities = softmax(np.array(logits))
    assert probabilities.sum() == pytest.approx(1.0)
    assert (probabilities >= 0).all()
    assert probabilities[int(np.argmax(logits))] == probabilities.max()


def test_known_box_gets_the_detectors_probabilities_of_known_landmarks() -> None:
    detector = ScriptedDetector(sofa())
    percept = Perceiver(detector, ScriptedMatcher(), known=("sofa", "Dining Table")).perceive(FRAME, "mug")
    (sighting,) = percept.sightings
    assert dict(sighting.probabilities) == pytest.approx({"sofa": 0.75, "Dining Table": 0.25})


@pytest.mark.parametrize("probabilities", [(), (("chair", 1.0),), (("sofa", math.nan),)])
def test_known_box_without_usable_probabilities_is_certain(probabilities: tuple[tuple[str, float], ...]) -> None:
    percept = perceive(ScriptedMatcher(), Detection(SOFA_BOX, "sofa", 0.9, probabilities))
    assert percept.sightings[0].probabilities == (("sofa", 1.0),)


def test_things_are_where_they_stand() -> None:
    matcher = ScriptedMatcher({DESK_BOX: {"desk": 27.0}, MUG_BOX: {"mug": 31.0}})
    percept = perceive(matcher, sofa(), unknown(DESK_BOX), unknown(MUG_BOX))
    seen = {sighting.label: sighting for sighting in percept.sightings}
    assert set(seen) == {"sofa", "desk"}
    for label, solid in (("sofa", SOFA), ("desk", DESK)):
        x, y, z = seen[label].position
        assert solid[0][0] - 0.05 <= x <= solid[1][0] + 0.05
        assert y == pytest.approx((solid[0][1] + solid[1][1]) / 2, abs=0.15)
        assert 0.1 <= z <= 0.8
        assert seen[label].radius == pytest.approx((solid[1][1] - solid[0][1]) / 2, rel=0.35)
    (candidate,) = percept.candidates
    np.testing.assert_allclose(candidate.position, (3.05, 0.54, 0.8), atol=0.06)
    assert candidate.frame is FRAME
    assert candidate.target == "mug"


def test_matcher_is_called_once_with_landmarks_and_target() -> None:
    matcher = ScriptedMatcher()
    perceive(matcher, sofa(), unknown(DESK_BOX), unknown(MUG_BOX))
    assert len(matcher.calls) == 1
    boxes, texts = matcher.calls[0]
    assert sorted(boxes) == sorted([DESK_BOX, MUG_BOX])
    assert texts == [*NAMES, "mug"]


def test_matcher_rests_when_there_is_nothing_to_match() -> None:
    matcher = ScriptedMatcher()
    assert perceive(matcher) == Percept()
    assert len(perceive(matcher, sofa()).sightings) == 1
    assert matcher.calls == []


@pytest.mark.parametrize(("score", "found"), [(28.9, 0), (29.0, 1), (35.0, 1)])
def test_candidate_needs_the_threshold(score: float, found: int) -> None:
    assert len(perceive(ScriptedMatcher({MUG_BOX: {"mug": score}}), unknown(MUG_BOX)).candidates) == found


@pytest.mark.parametrize(("score", "seen"), [(23.9, 0), (24.0, 1)])
def test_landmark_needs_its_own_threshold(score: float, seen: int) -> None:
    assert len(perceive(ScriptedMatcher({DESK_BOX: {"desk": score}}), unknown(DESK_BOX)).sightings) == seen


def test_what_matches_the_target_is_no_landmark() -> None:
    percept = perceive(ScriptedMatcher({DESK_BOX: {"desk": 30.0, "mug": 30.0}}), unknown(DESK_BOX))
    assert percept.sightings == ()
    assert len(percept.candidates) == 1


def test_mug_is_no_desk_however_well_it_matches() -> None:
    matcher = ScriptedMatcher({MUG_BOX: {"desk": 30.0}})
    assert perceive(matcher, unknown(MUG_BOX)).sightings == ()
    assert len(perceive(matcher, unknown(MUG_BOX), min_landmark_size=0.05).sightings) == 1


def test_candidates_come_best_first_and_once_each() -> None:
    near = Box(MUG_BOX.x0 + 0.5, MUG_BOX.y0, MUG_BOX.x1 + 0.5, MUG_BOX.y1)
    matcher = ScriptedMatcher({MUG_BOX: {"mug": 30.0}, near: {"mug": 32.0}, DESK_BOX: {"mug": 31.0}})
    percept = perceive(matcher, unknown(MUG_BOX), unknown(DESK_BOX), unknown(near))
    assert [(candidate.score, candidate.box) for candidate in percept.candidates] == [(32.0, near), (31.0, DESK_BOX)]


def test_known_class_wins_over_an_unknown_box_of_the_same_thing() -> None:
    near = Box(SOFA_BOX.x0 + 1, SOFA_BOX.y0, SOFA_BOX.x1 + 1, SOFA_BOX.y1)
    percept = perceive(ScriptedMatcher({near: {"armchair": 29.0}}), unknown(near, 0.99), sofa(score=0.5))
    assert [sighting.label for sighting in percept.sightings] == ["sofa"]


def test_sightings_come_best_first() -> None:
    matcher = ScriptedMatcher({DESK_BOX: {"desk": 27.0}})
    percept = perceive(matcher, sofa(score=0.4), unknown(DESK_BOX, 0.7))
    assert [sighting.score for sighting in percept.sightings] == [0.7, 0.4]


def test_sighting_cut_off_by_the_border_counts_less() -> None:
    whole, cut = sofa(), sofa(Box(SOFA_BOX.x0, SOFA_BOX.y0, 320.0, SOFA_BOX.y1))
    (first,), (second,) = (perceive(ScriptedMatcher(), detection).sightings for detection in (whole, cut))
    assert second.score == pytest.approx(first.score / 2)


def test_known_class_that_the_target_names_is_matched_too() -> None:
    matcher = ScriptedMatcher({SOFA_BOX: {"the red sofa": 31.0}})
    percept = perceive(matcher, sofa(), target="the red sofa")
    assert [candidate.box for candidate in percept.candidates] == [SOFA_BOX]
    assert len(percept.sightings) == 1  # it still is a landmark


def test_known_class_that_is_no_landmark_is_matched_only_if_named() -> None:
    bottle = Detection(MUG_BOX, "bottle", 0.9, (("bottle", 1.0),))
    matcher = ScriptedMatcher(default=31.0)
    assert perceive(matcher, bottle, target="mug") == Percept()
    assert len(perceive(matcher, bottle, target="spray bottle").candidates) == 1


def test_box_without_depth_is_left_out() -> None:
    sky = Box(100, 2, 160, 40)
    percept = perceive(ScriptedMatcher(default=31.0), unknown(sky), Detection(sky, "sofa", 0.9), target="kite")
    assert percept == Percept()


def test_depth_and_pose_are_those_of_the_frame() -> None:
    other = frame_of([((2.0, -0.5, 0.2), (2.5, 0.5, 0.8))])
    box = box_around(((2.0, -0.5, 0.2), (2.5, 0.5, 0.8)), other)
    perceiver = Perceiver(ScriptedDetector(unknown(box)), ScriptedMatcher(default=26.0), unknown=NAMES)
    assert perceiver.perceive(other, "mug").sightings[0].position[0] == pytest.approx(2.1, abs=0.15)


@pytest.mark.parametrize("target", ["", "  ", "mug"])
def test_empty_lists_and_targets_are_no_trouble(target: str) -> None:
    detections = (sofa(), unknown(DESK_BOX))
    perceiver = Perceiver(ScriptedDetector(*detections), ScriptedMatcher(default=30.0), known=(), unknown=())
    percept = perceiver.perceive(FRAME, target)
    assert percept.sightings == ()
    assert len(percept.candidates) == bool(target.strip())
    assert len(perceive(ScriptedMatcher(default=25.0), *detections, target=target).sightings) == 2


def test_same_frame_gives_the_same_percept() -> None:
    matcher = ScriptedMatcher({DESK_BOX: {"desk": 27.0}, MUG_BOX: {"mug": 31.0}})
    detections = (sofa(), unknown(DESK_BOX), unknown(MUG_BOX))
    assert perceive(matcher, *detections) == perceive(matcher, *detections)
    assert perceive(matcher, *detections) == perceive(matcher, *reversed(detections))


number = st.one_of(st.floats(-50, 400), st.sampled_from([math.nan, math.inf, -math.inf]))


@settings(max_examples=80, deadline=None)
@given(
    raw=st.lists(
        st.tuples(
            st.builds(Box, number, number, number, number),
            st.sampled_from(["sofa", "chair", UNKNOWN_CLASS, ""]),
            number,
        ),
        max_size=6,
    ),
    default=number,
    target=st.sampled_from(["mug", "sofa", "", "desk"]),
)
def test_whatever_the_models_say_the_percept_is_finite(
    raw: list[tuple[Box, str, float]], default: float, target: str
) -> None:
    detections = [Detection(box, label, score, ((label, score),)) for box, label, score in raw]
    percept = perceive(ScriptedMatcher(default=default), *detections, target=target)
    for sighting in percept.sightings:
        probabilities = [p for _, p in sighting.probabilities]
        assert np.isfinite([*sighting.position, sighting.radius, sighting.score, *probabilities]).all()
        assert sum(probabilities) == pytest.approx(1.0)
    for candidate in percept.candidates:
        assert isinstance(candidate, Candidate)
        assert np.isfinite([*candidate.position, candidate.score, *candidate.box]).all()
        assert candidate.patch.size > 0


def test_scores_of_the_wrong_shape_are_refused() -> None:
    class Broken:
        def match(self, frame: object, boxes: object, texts: object) -> np.ndarray:
            return np.zeros((1, 1))

    perceiver = Perceiver(ScriptedDetector(unknown(DESK_BOX)), Broken(), unknown=NAMES)
    with pytest.raises(InputError, match=r"matcher: scores of shape \(1, 1\) \(should be \(1, 4\)\)"):
        perceiver.perceive(FRAME, "mug")


@pytest.mark.parametrize("temperature", [0.0, -1.0, math.nan])
def test_temperature_out_of_range_is_refused(temperature: float) -> None:
    with pytest.raises(InputError, match="thresholds: temperature"):
        Thresholds(temperature=temperature)


def test_empty_name_is_refused() -> None:
    with pytest.raises(InputError, match="perceiver: a landmark's name is empty"):
        Perceiver(ScriptedDetector(), ScriptedMatcher(), unknown=("desk", " "))


def test_default_landmarks_hold_the_papers() -> None:
    assert set(DEFAULT_KNOWN_LANDMARKS) == {"tv monitor", "sofa", "dining table"}
    assert {"armchair", "side table", "coffee table", "desk", "bed", "drawer"} <= set(DEFAULT_UNKNOWN_LANDMARKS)
    assert not set(DEFAULT_KNOWN_LANDMARKS) & set(DEFAULT_UNKNOWN_LANDMARKS)


def test_class_that_the_detector_is_not_sure_of_is_told_by_matching() -> None:
    matcher = ScriptedMatcher({SOFA_BOX: {"bed": 26.0, "mug": 31.0}})
    sure = perceive(matcher, sofa(score=0.4), known=0.4)
    assert [sighting.label for sighting in sure.sightings] == ["sofa"]
    assert not sure.candidates
    unsure = perceive(matcher, sofa(score=0.39), known=0.4, target="lamp")
    assert [sighting.label for sighting in unsure.sightings] == ["bed"]
    assert perceive(matcher, sofa(score=0.39), known=0.4).candidates


def test_names_of_known_landmarks_are_for_boxes_of_unsure_class() -> None:
    scores = {"sofa": 30.0, "bed": 29.0}
    matcher = ScriptedMatcher({SOFA_BOX: scores, DESK_BOX: scores})
    percept = perceive(matcher, sofa(score=0.39), unknown(DESK_BOX), known=0.4)
    told = {sighting.label: dict(sighting.probabilities) for sighting in percept.sightings}
    assert set(told) == {"sofa", "bed"}
    assert set(told["sofa"]) == {*NAMES, "sofa"}
    assert set(told["bed"]) == set(NAMES)
    assert len(matcher.calls) == 1


def test_candidates_score_less_the_less_the_detector_trusts_them() -> None:
    matcher = ScriptedMatcher({MUG_BOX: {"mug": 35.0}})
    for confidence, expected in ((1.0, 35.0), (0.9, 35 + 10 * math.log(0.9)), (0.5, None)):
        candidates = perceive(matcher, unknown(MUG_BOX, confidence), trust=10.0).candidates
        assert [each.score for each in candidates] == ([] if expected is None else [pytest.approx(expected)])


@pytest.mark.parametrize("trust", [-1.0, math.inf])
def test_trust_out_of_range_is_refused(trust: float) -> None:
    with pytest.raises(InputError, match="thresholds: trust"):
        Thresholds(trust=trust)


def test_faint_boxes_are_not_looked_at() -> None:
    matcher = ScriptedMatcher(default=30.0)
    assert not perceive(matcher, unknown(MUG_BOX, 0.2), detection=0.3).candidates
    assert not matcher.calls
    assert perceive(matcher, unknown(MUG_BOX, 0.3), detection=0.3).candidates
