from __future__ import annotations

import numpy as np
import pytest
from seen_worlds import look, piece, room, seen, thing

from sim.perception import MatcherSettings, SimMatcher
from sim.perception.matcher import what_it_shows
from sim.perception.words import parse_text
from zavis_bt.errors import InputError
from zavis_bt.protocols import Matcher
from zavis_bt.types import Box, CameraIntrinsics, RgbdFrame, entropy

ALIKE = {
    frozenset(pair): value
    for *pair, value in (
        ("mug", "cup", 0.21),
        ("side table", "coffee table", 0.55),
        ("desk", "furniture", 0.22),
        ("side table", "furniture", 0.26),
        ("coffee table", "furniture", 0.28),
        ("bed", "furniture", 0.34),
    )
}
STRICT = MatcherSettings(lookalikes=0.0)


def similarity(a: str, b: str) -> float:
    return 1.0 if a == b else ALIKE.get(frozenset((a, b)), 0.0)


def matcher(seed: int = 0, settings: MatcherSettings = STRICT) -> SimMatcher:
    return SimMatcher(similarity, np.random.default_rng(seed), settings)


def scores(world, instance: str, texts: list[str], seeds: int = 120, x: float = 1.0) -> np.ndarray:
    """Scores (seeds, texts) of the instance's own box."""
    frame = look(world, x, 2.0)
    view = seen(frame, instance)
    assert view is not None
    return np.array([matcher(seed).match(frame, [view.box], texts)[0] for seed in range(seeds)])


def test_it_is_a_matcher_and_scores_every_box_against_every_text():
    checked: Matcher = matcher()
    frame = look(room(), 1.0, 2.0)
    assert checked.match(frame, [Box(0, 0, 9, 9), Box(5, 5, 50, 50)], ["mug", "bed", "cup"]).shape == (2, 3)
    assert checked.match(frame, [], ["mug"]).shape == (0, 1)


def test_the_name_beats_a_related_word_and_that_an_unrelated_one():
    found = scores(room((), (thing("mug", 2.0, 2.0, 0.85),)), "mug_1", ["mug", "cup", "book"])
    same, related, unrelated = found.mean(axis=0)
    assert same == pytest.approx(31.4, abs=0.3)
    assert same > related + 2
    assert related > unrelated + 2
    assert unrelated == pytest.approx(20, abs=0.3)


def test_most_true_matches_pass_the_threshold_and_unrelated_ones_do_not():
    found = scores(room((), (thing("mug", 2.0, 2.0, 0.85),)), "mug_1", ["mug", "book"])
    assert 0.9 < (found[:, 0] > 29).mean() <= 1.0
    assert (found[:, 1] > 29).mean() == 0.0


def test_small_crops_match_worse():
    near = scores(room((), (thing("mug", 1.7, 2.0, 0.85),)), "mug_1", ["mug"]).mean()
    far = scores(room((), (thing("mug", 5.5, 2.0, 0.85),)), "mug_1", ["mug"]).mean()
    assert far < near - 0.5


def test_hidden_things_match_worse():
    screen = piece("shelf", 2.0, 1.75, 2.0)
    free = scores(room((), (thing("box", 3.0, 2.0, 0.7),)), "box_1", ["box"]).mean()
    hidden = scores(room((screen,), (thing("box", 3.0, 2.0, 0.7),)), "box_1", ["box"]).mean()
    assert hidden < free


def test_badly_placed_boxes_match_worse():
    frame = look(room((), (thing("box", 2.5, 2.0, 0.7),)), 1.0, 2.0)
    box = frame.instances[0].box
    shifted = Box(box.x0 + 60, box.y0, box.x1 + 60, box.y1)
    found = np.array([matcher(seed).match(frame, [box, shifted], ["box"])[:, 0] for seed in range(100)])
    assert found[:, 1].mean() < found[:, 0].mean() - 1


def test_a_box_on_nothing_matches_nothing():
    found = np.array(
        [matcher(seed).match(look(room(), 1.0, 2.0), [Box(9, 9, 80, 80)], ["mug"])[0, 0] for seed in range(200)]
    )
    assert found.mean() == pytest.approx(17, abs=0.4)
    assert found.max() < 29


def test_colours_tell_things_of_one_kind_apart():
    mugs = room(
        (), (thing("mug", 2.0, 1.8, 0.85, colour="red"), thing("mug", 2.0, 2.2, 0.85, colour="black", number=2))
    )
    texts = ["red mug", "A photo of a black mug", "mug"]
    red, black = scores(mugs, "mug_1", texts), scores(mugs, "mug_2", texts)
    assert red[:, 0].mean() > black[:, 0].mean() + 2
    assert black[:, 1].mean() > red[:, 1].mean() + 2
    assert red[:, 2].mean() == pytest.approx(black[:, 2].mean(), abs=0.4)
    assert (red[:, 0] > black[:, 0]).mean() > 0.9


def test_a_colour_does_not_make_a_book_a_mug():
    found = scores(room((), (thing("book", 2.0, 2.0, 0.85, colour="red"),)), "book_1", ["red mug"])
    assert found.max() < 29


@pytest.mark.parametrize(
    ("text", "noun", "colour"),
    [
        ("red wallet", "wallet", "red"),
        ("A photo of a red wallet", "wallet", "red"),
        ("the Gray   cell phone", "cell phone", "grey"),
        ("mug", "mug", None),
        ("the red one", "one", "red"),
    ],
)
def test_texts_are_parsed(text, noun, colour):
    assert parse_text(text) == (noun, colour)


def test_colour_words_are_at_least_ten():
    words = ["black", "white", "grey", "red", "orange", "yellow", "green", "blue", "purple", "pink", "brown"]
    assert [parse_text(f"{word} box").colour for word in words] == words


def test_instances_keep_their_luck_and_views_add_to_it():
    world = room((), (thing("mug", 2.0, 2.0, 0.85),))
    table = np.empty((150, 2))
    for seed in range(150):
        for k in range(2):
            frame = look(world, 1.0, 2.0, stamp=float(k))
            table[seed, k] = matcher(seed).match(frame, [frame.instances[0].box], ["mug"])[0, 0]
    assert 0.2 < np.corrcoef(table.T)[0, 1] < 0.7
    assert table.std() == pytest.approx(np.hypot(0.7, 0.8), abs=0.15)


def test_kinds_of_table_are_confusable_and_more_views_help():
    names = ["side table", "coffee table", "desk", "bed"]
    world = room((piece("side table", 2.5, 2.0, 0.6),))
    single, fused = [], []
    for seed in range(60):
        logs = []
        for k in range(5):
            frame = look(world, 1.0, 2.0, tilt=-0.2, stamp=float(k))
            found = matcher(seed).match(frame, [frame.instances[0].box], names)[0]
            logs.append(found - np.log(np.exp(found).sum()))
        single.append(entropy(np.exp(logs[0])))
        total = np.sum(logs, axis=0)
        fused.append(entropy(np.exp(total - np.log(np.exp(total - total.max()).sum()) - total.max())))
    assert 0.2 < np.mean(single) < 1.0
    assert np.mean(fused) < 0.6 * np.mean(single)


def test_objects_sometimes_look_like_something_else():
    frame = look(
        room((), tuple(thing("mug", 2.0 + 0.2 * k, 1.4 + 0.3 * k, 0.85, number=k) for k in range(5))), 1.0, 2.0
    )
    boxes = [view.box for view in frame.instances]
    found = np.array([matcher(seed, MatcherSettings()).match(frame, boxes, ["book"]) for seed in range(300)])
    assert 0.001 < (found > 29).mean() < 0.02


def test_a_part_of_furniture_shows_the_furniture():
    frame = look(room((piece("desk", 2.5, 2.0, 0.9, size=1.5),)), 1.0, 2.0, tilt=-0.3)
    box = frame.instances[0].box
    part = Box(box.x0 + 20, box.y0 + 20, box.x0 + 120, box.y0 + 120)
    shown, overlap = what_it_shows(part, frame.instances)
    assert shown is not None
    assert shown.id == "desk_1"
    assert overlap < 0.5


def test_the_order_of_questions_does_not_matter():
    world = room((piece("desk", 3.0, 2.0, 0.8),), (thing("mug", 3.0, 2.0, 0.8, on="desk_1"),))
    frame = look(world, 1.0, 2.0, tilt=-0.2)
    boxes = [view.box for view in frame.instances]
    one, two = matcher(5), matcher(5)
    together = one.match(frame, boxes, ["mug", "desk"])
    apart = np.column_stack([two.match(frame, boxes, [text])[:, 0] for text in ("desk", "mug")])[:, ::-1]
    np.testing.assert_array_equal(together, apart)


def test_a_foreign_frame_is_refused():
    blank = np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4), np.float32)
    frame = RgbdFrame(CameraIntrinsics(4, 4, 4.0, 4.0, 2.0, 2.0), np.eye(4), 0.0, lambda: blank)
    with pytest.raises(InputError, match="simulated camera"):
        matcher().match(frame, [Box(0, 0, 2, 2)], ["mug"])
