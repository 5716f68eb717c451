from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from zavis_bt.errors import InputError
from zavis_bt.mapping import SemanticMap
from zavis_bt.types import LandmarkSighting

LABELS = ("bed", "desk", "dresser", "shelf", "sofa", "television")


def sighting(
    label: str | dict[str, float], x: float, y: float = 0.0, radius: float = 0.6, stamp: float = 0.0, score: float = 0.8
) -> LandmarkSighting:
    shares = {label: 0.8, "shelf": 0.2} if isinstance(label, str) else label
    return LandmarkSighting(tuple(shares.items()), (x, y, 0.5), radius, score, stamp)


def map_of(*sightings: LandmarkSighting) -> SemanticMap:
    semantic = SemanticMap()
    semantic.integrate(sightings)
    return semantic


@st.composite
def distributions(draw: st.DrawFn) -> dict[str, float]:
    weights = np.array(draw(st.lists(st.floats(0.01, 1.0), min_size=6, max_size=6)))
    return dict(zip(LABELS, (weights / weights.sum()).tolist(), strict=True))


VIEWS = st.lists(
    st.tuples(distributions(), st.floats(-0.05, 0.05), st.floats(0.4, 0.6), st.floats(0.0, 1.0)), min_size=2, max_size=6
)


@settings(deadline=None)
@given(views=VIEWS, data=st.data())
def test_the_order_of_views_does_not_matter(
    views: list[tuple[dict[str, float], float, float, float]], data: st.DataObject
) -> None:
    seen = [sighting(p, x, radius=r, score=score) for p, x, r, score in views]
    frames = [LandmarkSighting(s.probabilities, s.position, s.radius, s.score, float(i)) for i, s in enumerate(seen)]
    shuffled = data.draw(st.permutations(frames))
    one, other = SemanticMap(), SemanticMap()
    for a, b in zip(frames, shuffled, strict=True):
        one.integrate([a])
        other.integrate([b])
    (first,), (second,) = one.landmarks, other.landmarks
    assert dict(first.probabilities) == pytest.approx(dict(second.probabilities), abs=1e-9)
    assert first.position == pytest.approx(second.position)
    assert first.radius == pytest.approx(second.radius)
    assert first.views == second.views == len(views)


@settings(deadline=None)
@given(distribution=distributions())
def test_entropy_falls_as_views_agree(distribution: dict[str, float]) -> None:
    semantic, entropies = SemanticMap(), []
    for stamp in range(5):
        semantic.integrate([sighting(distribution, 0.0, stamp=stamp)])
        entropies.append(semantic.landmarks[0].entropy)
    assert all(later <= earlier + 1e-9 for earlier, later in itertools.pairwise(entropies))
    if max(distribution.values()) - min(distribution.values()) > 0.05:
        assert entropies[-1] < entropies[0]


def test_entropy_rises_when_views_disagree() -> None:
    semantic = map_of(sighting({"bed": 0.95, "desk": 0.05}, 0.0))
    before = semantic.landmarks[0].entropy
    semantic.integrate([sighting({"bed": 0.05, "desk": 0.95}, 0.05, stamp=1.0)])
    (landmark,) = semantic.landmarks
    assert landmark.entropy == pytest.approx(math.log(2))
    assert landmark.entropy > before


def test_a_single_view_keeps_its_distribution() -> None:
    (landmark,) = map_of(sighting({"bed": 0.7, "desk": 0.2, "sofa": 0.1}, 1.0)).landmarks
    assert dict(landmark.probabilities) == pytest.approx({"bed": 0.7, "desk": 0.2, "sofa": 0.1})
    assert (landmark.position, landmark.radius, landmark.views) == ((1.0, 0.0, 0.5), 0.6, 1)


def test_probabilities_sum_to_one_best_first() -> None:
    semantic = map_of(sighting("desk", 0.0), sighting({"sofa": 1.0}, 0.1, stamp=1.0))
    shares = [p for _, p in semantic.landmarks[0].probabilities]
    assert sum(shares) == pytest.approx(1.0)
    assert shares == sorted(shares, reverse=True)


def test_no_view_rules_a_label_out_for_good() -> None:
    semantic = map_of(sighting({"desk": 1.0, "sofa": 0.0}, 0.0))
    for stamp in range(1, 4):
        semantic.integrate([sighting({"desk": 0.0, "sofa": 1.0}, 0.0, stamp=stamp)])
    assert semantic.landmarks[0].label == "sofa"


def test_two_desks_side_by_side_stay_two() -> None:
    semantic, rng = SemanticMap(), np.random.default_rng(0)
    for stamp in range(30):
        noise = rng.normal(0, 0.08, 4)
        pair = [
            sighting("desk", noise[0], noise[1], stamp=stamp),
            sighting("desk", 1.25 + noise[2], noise[3], stamp=stamp),
        ]
        semantic.integrate(pair if stamp % 3 else pair[:1])
    assert [landmark.label for landmark in semantic.landmarks] == ["desk", "desk"]
    assert sorted(landmark.position[0] for landmark in semantic.landmarks) == pytest.approx([0.0, 1.25], abs=0.1)


def test_two_chairs_of_one_frame_are_two_however_near() -> None:
    assert len(map_of(sighting("chair", 0.0, radius=0.25), sighting("chair", 0.4, radius=0.25)).landmarks) == 2


def test_a_thing_boxed_twice_in_one_frame_is_one() -> None:
    semantic = map_of(sighting("desk", 0.0), sighting("desk", 0.1))
    assert [landmark.views for landmark in semantic.landmarks] == [1]


def test_a_bed_seen_from_its_other_side_is_the_same_bed() -> None:
    semantic = map_of(sighting("bed", 0.0, radius=1.0), sighting("bed", 0.9, radius=0.8, stamp=1.0))
    assert [landmark.views for landmark in semantic.landmarks] == [2]


def test_different_things_in_one_place_are_two() -> None:
    semantic = map_of(sighting({"desk": 1.0}, 0.0), sighting({"television": 1.0}, 0.1, radius=0.2, stamp=1.0))
    assert len(semantic.landmarks) == 2


def test_parts_of_one_thing_merge_when_they_turn_out_to_overlap() -> None:
    semantic = map_of(sighting("sofa", 0.0, radius=0.2), sighting("sofa", 0.6, radius=0.2))
    assert len(semantic.landmarks) == 2
    old, gone = (landmark.id for landmark in semantic.landmarks)
    semantic.mark_visited(gone)
    semantic.integrate([sighting("sofa", 0.3, radius=0.9, stamp=1.0)])
    (landmark,) = semantic.landmarks
    assert (landmark.id, landmark.views) == (old, 3)
    assert semantic.visited == {old}
    assert semantic.resolve(gone) == old


def test_visits_are_remembered_until_they_are_forgotten() -> None:
    semantic = map_of(sighting("desk", 0.0), sighting("bed", 3.0))
    semantic.mark_visited(1)
    assert semantic.visited == {1}
    semantic.forget_visits()
    assert semantic.visited == set()


def test_the_position_follows_the_more_certain_views() -> None:
    semantic = map_of(sighting("desk", 0.0, score=0.9), sighting("desk", 0.4, score=0.1, stamp=1.0))
    assert semantic.landmarks[0].position[0] == pytest.approx(0.04)


def test_the_radius_grows_with_what_is_seen_but_not_without_bound() -> None:
    semantic = SemanticMap()
    for stamp, x in enumerate(np.linspace(-0.6, 0.6, 13)):
        semantic.integrate([sighting("bed", float(x), radius=0.6, stamp=float(stamp))])
    (landmark,) = semantic.landmarks
    assert 0.6 < landmark.radius <= 1.2


def test_the_version_grows_with_every_change() -> None:
    semantic = SemanticMap()
    semantic.integrate([])
    assert semantic.version == 0
    semantic.integrate([sighting("desk", 0.0)])
    assert semantic.version == 1


@settings(deadline=None)
@given(views=VIEWS)
def test_a_saved_map_is_loaded_unchanged_and_goes_on(
    tmp_path_factory: pytest.TempPathFactory, views: list[tuple[dict[str, float], float, float, float]]
) -> None:
    path = tmp_path_factory.mktemp("map") / "semantic_map.json"
    semantic = SemanticMap()
    for stamp, (shares, x, radius, score) in enumerate(views):
        semantic.integrate([sighting(shares, x, radius=radius, score=score, stamp=stamp)])
    semantic.save(path)
    loaded = SemanticMap.load(path)
    (before,), (after,) = semantic.landmarks, loaded.landmarks
    assert dict(after.probabilities) == pytest.approx(dict(before.probabilities))
    assert after.position == pytest.approx(before.position)
    assert (after.id, after.views, after.radius) == (before.id, before.views, pytest.approx(before.radius))
    loaded.integrate([sighting("desk", 0.0, stamp=99.0), sighting("sofa", 5.0, stamp=99.0)])
    assert [landmark.id for landmark in loaded.landmarks] == [0, 1]
    assert loaded.landmarks[0].views == before.views + 1


ENTRY = '{"id": 1, "probabilities": [["desk", 1.0]], "position": [0, 0, 0], "radius": 0.5, "views": 1}'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nonsense", "semantic map: Invalid JSON"),
        ('{"format": "zavis-semantic-map/2", "landmarks": []}', "format: .*'zavis-semantic-map/1'"),
        ('{"landmarks": []}', "format: Field required"),
        (f'{{"format": "zavis-semantic-map/1", "landmarks": [{ENTRY}, {ENTRY}]}}', "two landmarks have the same id"),
        (
            f'{{"format": "zavis-semantic-map/1", "landmarks": [{ENTRY.replace("1.0", "0.5")}]}}',
            "landmarks: 0: the probabilities sum to 0.5, not to 1",
        ),
        (
            f'{{"format": "zavis-semantic-map/1", "landmarks": [{ENTRY.replace("0.5", "-1")}]}}',
            "landmarks: 0: radius: .*greater than or equal to 0",
        ),
    ],
)
def test_a_wrong_file_is_explained(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        SemanticMap.from_json(text)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.json: no such file"):
        SemanticMap.load(tmp_path / "none.json")
