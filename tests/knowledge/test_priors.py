from __future__ import annotations

import time
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from zavis_bt.errors import InputError
from zavis_bt.knowledge import PRIORS, WordVectors, commonsense, load_table, make_prior, priors
from zavis_bt.protocols import KnowledgePrior

T_C = 0.2  # the paper's threshold below which a landmark is skipped
FURNITURE = (
    "sofa", "bed", "desk", "dining table", "armchair", "side table", "coffee table", "dresser", "shelf",
    "tv stand", "floor lamp", "garbage can", "safe", "ottoman", "cabinet", "drawer", "countertop",
)  # fmt: skip


@pytest.fixture(scope="module")
def prior() -> KnowledgePrior:
    return make_prior("commonsense")


def p(prior: KnowledgePrior, target: str, landmark: str) -> float:
    return float(prior.probability(target, [landmark])[0])


@pytest.mark.parametrize(
    ("target", "likely", "unlikely"),
    [
        ("pillow", "bed", "desk"),
        ("pillow", "sofa", "desk"),
        ("book", "desk", "garbage can"),
        ("book", "shelf", "floor lamp"),
        ("alarm clock", "side table", "tv stand"),
        ("alarm clock", "nightstand", "tv stand"),
        ("remote control", "sofa", "desk"),
        ("remote control", "coffee table", "garbage can"),
        ("remote control", "tv stand", "countertop"),
        ("remote control", "tv monitor", "dining table"),
        ("toothbrush", "bathroom sink", "bed"),
        ("bowl", "countertop", "bed"),
        ("bowl", "dining table", "sofa"),
        ("laptop", "desk", "dresser"),
        ("teddy bear", "bed", "dining table"),
        ("cd", "shelf", "bed"),
        ("cell phone", "side table", "cabinet"),
        ("spray bottle", "cabinet", "bed"),
        ("apple", "dining table", "sofa"),
        ("pot", "countertop", "armchair"),
        ("wallet", "dresser", "armchair"),
        ("ps5 controller", "tv stand", "bed"),
        ("orange juice", "fridge", "bed"),
    ],
)
def test_likely_place_beats_the_unlikely_one(prior: KnowledgePrior, target: str, likely: str, unlikely: str) -> None:
    assert p(prior, target, likely) > p(prior, target, unlikely) + T_C


@pytest.mark.parametrize(
    ("target", "landmark"),
    [("pillow", "desk"), ("alarm clock", "tv stand"), ("toothbrush", "bed"), ("bowl", "bed"), ("book", "garbage can")],
)
def test_absurd_place_falls_below_the_threshold(prior: KnowledgePrior, target: str, landmark: str) -> None:
    assert p(prior, target, landmark) < T_C


def test_every_object_passes_the_threshold_at_each_of_its_usual_places(prior: KnowledgePrior) -> None:
    for name, places in load_table().objects.items():
        assert (prior.probability(name, places) > 2 * T_C).all(), name


def test_most_usual_place_is_certain_and_the_next_ones_follow(prior: KnowledgePrior) -> None:
    places = load_table().objects["book"]
    assert p(prior, "book", places[0]) == 1.0
    assert (np.diff(prior.probability("book", places)) <= 0).all()


def test_without_decay_the_maximum_is_ungraded() -> None:
    places = load_table().objects["book"]
    np.testing.assert_array_equal(commonsense(decay=0.0).probability("book", places), 1.0)


def test_different_furniture_is_below_the_calibration_floor() -> None:
    places = load_table().places
    cosines = WordVectors().similarities(places, places)[np.triu_indices(len(places), 1)]
    assert (cosines > 0.3).mean() < 0.03


def test_adjectives_number_and_spelling_do_not_matter(prior: KnowledgePrior) -> None:
    expected = prior.probability("wallet", FURNITURE)
    for spelling in ("red wallet", "Wallets", "my old WALLET with a zip", "a_wallet"):
        np.testing.assert_array_equal(prior.probability(spelling, FURNITURE), expected)


def test_synonyms_of_a_landmark_are_the_same_place(prior: KnowledgePrior) -> None:
    for target in ("book", "pillow", "mug"):
        for name, other in [("sofa", "couch"), ("side table", "nightstand"), ("countertop", "kitchen counter")]:
            assert p(prior, target, name) == p(prior, target, other)


def test_landmark_that_is_sought_is_where_it_is(prior: KnowledgePrior) -> None:
    probabilities = prior.probability("the grey sofa", FURNITURE)
    assert probabilities[0] == 1.0
    assert (probabilities[1:] < T_C).all()


def test_thing_never_heard_of_skips_no_landmark_and_prefers_where_most_things_are(prior: KnowledgePrior) -> None:
    for target in ("asdfgh", "quantum flux capacitor", ""):
        probabilities = prior.probability(target, FURNITURE)
        assert (probabilities > T_C).all()
        assert p(prior, target, "drawer") > p(prior, target, "floor lamp")


def test_landmarks_are_judged_one_by_one(prior: KnowledgePrior) -> None:
    for target in ("book", "ps5 controller", "asdfgh"):
        together = prior.probability(target, FURNITURE)
        np.testing.assert_allclose(together, [p(prior, target, landmark) for landmark in FURNITURE], atol=1e-12)


def test_own_table_decides(tmp_path: Path) -> None:
    path = tmp_path / "mine.txt"
    path.write_text("book: bathtub\n", encoding="utf-8")
    prior = commonsense(path)
    assert p(prior, "book", "bathtub") == 1.0
    assert p(prior, "book", "desk") < T_C


def test_word_prior_is_the_clipped_cosine() -> None:
    cosines = WordVectors().similarities(["pillow"], FURNITURE)[0]
    np.testing.assert_allclose(make_prior("word").probability("pillow", FURNITURE), np.clip(cosines, 0, 1))


def test_prior_without_knowledge_is_the_same_everywhere() -> None:
    np.testing.assert_array_equal(make_prior("none").probability("anything", FURNITURE), 1.0)


MADE = {name: make_prior(name) for name in PRIORS if name != "comet"}  # whose network does not come along


@settings(max_examples=40, deadline=None)
@given(target=st.text(max_size=80), landmarks=st.lists(st.text(max_size=30), max_size=4))
@pytest.mark.parametrize("name", sorted(MADE))
def test_every_prior_answers_any_text(name: str, target: str, landmarks: list[str]) -> None:
    probabilities = MADE[name].probability(target, landmarks)
    assert probabilities.shape == (len(landmarks),)
    assert probabilities.dtype == np.float64
    assert ((probabilities >= 0) & (probabilities <= 1)).all()


@pytest.mark.parametrize("name", sorted(MADE))
def test_answers_share_no_memory(name: str) -> None:
    first = MADE[name].probability("book", FURNITURE)
    kept = first.copy()
    first[:] = 7.0
    np.testing.assert_array_equal(MADE[name].probability("book", FURNITURE), kept)


def test_answers_come_quickly_once_warm(prior: KnowledgePrior) -> None:
    prior.probability("x" * 10_000, FURNITURE)
    start = time.perf_counter()
    for _ in range(100):
        prior.probability("book", FURNITURE)
    assert (time.perf_counter() - start) / 100 < 0.005


def test_unknown_prior_suggests_the_nearest_name() -> None:
    with pytest.raises(InputError, match=r"prior 'comonsense'.*did you mean 'commonsense'\?"):
        make_prior("comonsense")


def test_unknown_setting_names_the_choices() -> None:
    with pytest.raises(
        InputError, match=r"prior 'commonsense': .*'tabel' \(settings: table, neighbours, floor, decay\)"
    ):
        make_prior("commonsense", tabel="x")
    with pytest.raises(InputError, match=r"\(settings: none\)"):
        make_prior("none", table="x")


@pytest.mark.parametrize("setting", [{"neighbours": 0}, {"floor": 1.0}, {"floor": -0.1}, {"decay": 1.5}])
def test_settings_out_of_range_are_refused(setting: dict[str, float]) -> None:
    with pytest.raises(InputError, match=f"prior 'commonsense': {next(iter(setting))} is"):
        make_prior("commonsense", **setting)


def test_installed_priors_are_found_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    point = EntryPoint("mine", "zavis_bt.knowledge:none", priors.ENTRY_POINT_GROUP)
    monkeypatch.setattr(priors, "entry_points", lambda group: [point] if group == "zavis_bt.priors" else [])
    np.testing.assert_array_equal(make_prior("mine").probability("book", ["desk"]), 1.0)
