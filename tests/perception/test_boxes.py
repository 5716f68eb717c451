from __future__ import annotations

import math

import pytest
from perception_scene import INTRINSICS

from zavis_bt.perception.boxes import clip, suppress, touches_border
from zavis_bt.perception.naming import key, may_name
from zavis_bt.types import Box


def test_box_inside_the_image_is_left_alone() -> None:
    box = Box(10.5, 20.25, 30.0, 40.0)
    assert clip(box, INTRINSICS) == box


def test_box_beyond_the_image_is_cut() -> None:
    assert clip(Box(-5, -5, 1000, 1000), INTRINSICS) == Box(0, 0, 320, 240)


@pytest.mark.parametrize(
    "box",
    [Box(math.nan, 0, 5, 5), Box(0, 0, math.inf, 5), Box(400, 10, 500, 20), Box(10, 10, 10.4, 20), Box(9, 9, 3, 3)],
)
def test_box_that_shows_nothing_is_dropped(box: Box) -> None:
    assert clip(box, INTRINSICS) is None


def test_box_at_any_edge_touches_the_border() -> None:
    assert not touches_border(Box(10, 10, 300, 230), INTRINSICS)
    for box in (Box(0, 10, 50, 50), Box(10, 1, 50, 50), Box(10, 10, 319, 50), Box(10, 10, 50, 240)):
        assert touches_border(box, INTRINSICS)


def test_of_overlapping_boxes_the_first_is_kept() -> None:
    first, nearly, apart = Box(0, 0, 100, 100), Box(5, 0, 105, 100), Box(60, 0, 160, 100)
    assert suppress([first, nearly, apart], lambda box: box, 0.7) == [first, apart]


def test_class_names_are_compared_without_spaces_and_case() -> None:
    assert key("Dining table") == key("diningtable") == key("dining_table")


@pytest.mark.parametrize(
    ("target", "label", "expected"),
    [
        ("the red sofa", "sofa", True),
        ("Sofa", "sofa", True),
        ("spray bottle", "bottle", True),
        ("tv monitor", "tvmonitor", True),
        ("the tv", "tv monitor", True),
        ("dining table", "diningtable", True),
        ("educational toy", "cat", False),
        ("red wallet", "sofa", False),
        ("", "sofa", False),
    ],
)
def test_target_names_a_class_by_whole_words(target: str, label: str, expected: bool) -> None:
    assert may_name(target, label) is expected
