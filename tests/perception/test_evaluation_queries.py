from __future__ import annotations

import math
from pathlib import Path

import pytest
from datasets_on_disk import coco, write_coco

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import open_dataset
from zavis_bt.perception.evaluation import Query, judge_answers, queries_of
from zavis_bt.types import Box

HERE, THERE, FAR = Box(0, 0, 10, 10), Box(30, 10, 60, 40), Box(20, 0, 30, 10)


def box(category: int, place: Box, colour: str | None = None, ignored: bool = False) -> dict:
    x0, y0, x1, y1 = place
    fields = {"image_id": 7, "category_id": category, "bbox": [x0, y0, x1 - x0, y1 - y0], "iscrowd": int(ignored)}
    return fields | ({"colour": colour} if colour else {})


def queries(folder: Path, *boxes: dict) -> dict[str, Query]:
    names = [{"id": 1, "name": "mug"}, {"id": 2, "name": "book"}]
    found = queries_of(open_dataset(write_coco(folder, coco(annotations=list(boxes), categories=names))))
    return {query.text: query for query in found}


def test_each_category_and_each_colour_of_it_is_asked_once(tmp_path: Path) -> None:
    asked = queries(tmp_path, box(1, HERE, "red"), box(1, THERE, "blue"), box(1, FAR, "red"), box(2, FAR, "red"))
    assert set(asked) == {"mug", "red mug", "blue mug", "book", "red book"}
    assert asked["mug"].right == (HERE, THERE, FAR)
    assert asked["red mug"].right == (HERE, FAR)
    assert [name for name, query in asked.items() if query.coloured] == ["red mug", "blue mug", "red book"]


def test_colours_are_not_asked_where_one_is_not_told(tmp_path: Path) -> None:
    assert set(queries(tmp_path, box(1, HERE, "red"), box(1, THERE), box(2, FAR, "red"))) == {"mug", "book", "red book"}


def test_names_of_ignored_things_alone_are_not_asked(tmp_path: Path) -> None:
    asked = queries(tmp_path, box(1, HERE, "red", ignored=True), box(1, THERE, "blue"))
    assert set(asked) == {"mug", "blue mug"}
    assert (asked["mug"].right, asked["mug"].ignored) == ((THERE,), (HERE,))


def test_an_answer_is_right_on_any_thing_of_that_name() -> None:
    query = Query(0, "mug", False, (HERE, THERE), (FAR,))
    assert [query.verdict(answer) for answer in (HERE, THERE, FAR, None)] == [True, True, None, False]
    assert query.verdict(Box(0, 0, 10, 4.9)) is False


def test_rates_by_kind_and_size() -> None:
    asked = [
        Query(0, "mug", False, (HERE,)),
        Query(0, "red mug", True, (HERE,)),
        Query(0, "book", False, (THERE,)),
        Query(0, "pen", False, (THERE,), (FAR,)),
    ]
    result = judge_answers(asked, [HERE, None, THERE, FAR])  # the last one is neither right nor wrong
    assert (result.all.asked, result.all.right) == (3, pytest.approx(2 / 3))
    assert (result.categories.asked, result.categories.right) == (2, 1.0)
    assert (result.coloured.asked, result.coloured.right) == (1, 0.0)
    sizes = {rate.name: rate for rate in result.by_size}
    assert (sizes["0–16 px"].asked, sizes["0–16 px"].right) == (2, 0.5)
    assert (sizes["24–32 px"].asked, sizes["24–32 px"].right) == (1, 1.0)
    assert math.isnan(sizes["≥ 256 px"].right)


def test_nothing_asked_and_answers_too_few() -> None:
    assert judge_answers([], []).all.asked == 0
    with pytest.raises(InputError, match="0 answers to 1 queries"):
        judge_answers([Query(0, "mug", False, (HERE,))], [])
