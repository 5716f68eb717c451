from __future__ import annotations

import json
from pathlib import Path

import pytest
from datasets_on_disk import coco, write_coco

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import Annotation, open_dataset
from zavis_bt.types import Box


def changed(part: str, index: int, **fields: object) -> dict:
    document = coco()
    document[part][index] |= fields
    return document


def test_boxes_belong_to_their_images_whatever_the_ids(tmp_path: Path) -> None:
    dataset = open_dataset(write_coco(tmp_path))
    assert len(dataset) == 2
    assert dataset.annotations(0)[0] == Annotation(Box(10, 20, 40, 35), "sofa")
    assert dataset.annotations(1) == ()
    assert dataset.size(1) == (64, 48)


def test_crowds_are_ignored(tmp_path: Path) -> None:
    assert [a.ignored for a in open_dataset(write_coco(tmp_path)).annotations(0)] == [False, True]


def test_categories_are_spelled_as_the_project_spells_them(tmp_path: Path) -> None:
    assert open_dataset(write_coco(tmp_path)).categories == ("sofa", "red thing")


def test_colour_visible_share_and_origin_are_read_where_they_are_told(tmp_path: Path) -> None:
    document = changed("annotations", 0, colour="red", visible_fraction=0.25) | {"info": {"rendered": True}}
    dataset = open_dataset(write_coco(tmp_path, document))
    assert dataset.rendered
    assert dataset.annotations(0)[0] == Annotation(Box(10, 20, 40, 35), "sofa", "red", 0.25)
    assert dataset.annotations(0)[1].colour is None


@pytest.mark.parametrize("path", ["annotations/instances_val2017.json", ":val2017"])
def test_images_lie_as_in_coco_itself(tmp_path: Path, path: str) -> None:
    write_coco(tmp_path, images="val2017", file="annotations/instances_val2017.json")
    where = f"{tmp_path}{path}" if path.startswith(":") else tmp_path / path
    assert open_dataset(where).image(0).shape == (48, 64, 3)


def test_a_part_that_is_not_there_gets_the_ones_that_are(tmp_path: Path) -> None:
    write_coco(tmp_path, images="val2017", file="annotations/instances_val2017.json")
    with pytest.raises(InputError, match=r"no part 'val2014' \(did you mean 'val2017'\?\)"):
        open_dataset(f"{tmp_path}:val2014")
    with pytest.raises(InputError, match=r"name one, .*:val2017"):
        open_dataset(tmp_path)


def test_a_box_that_reaches_over_the_edge_by_rounding_is_cut(tmp_path: Path) -> None:
    dataset = open_dataset(write_coco(tmp_path, changed("annotations", 0, bbox=[-0.5, 1, 65, 20])))
    assert dataset.annotations(0)[0].box == Box(0, 1, 64, 21)


def test_a_few_boxes_without_area_among_very_many_are_left_out(tmp_path: Path) -> None:
    boxes = [{"id": k, "image_id": 3, "category_id": 5, "bbox": [1, 1, 5, 5 * (k > 0)]} for k in range(10_000)]
    assert len(open_dataset(write_coco(tmp_path, coco(annotations=boxes))).annotations(1)) == 9_999


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (coco(images=[], annotations=[]), r"annotations.json: holds no images \(an empty data set\)"),
        (coco(annotations=[]), r"holds no boxes"),
        (coco(categories=[]), r"annotations\[0\]: category_id 5 has no name among the categories"),
        (changed("categories", 1, name=""), r"categories\[1\]: should have a name"),
        (changed("annotations", 1, image_id=99), r"annotations\[1\]: image_id 99 has no image"),
        (changed("annotations", 0, bbox=[60, 40, 30, 30]), r"annotation 1 of a.jpg: box 60, 40, 90, 70 reaches out"),
        (changed("annotations", 0, bbox=[60, 40, 0, 3]), r"annotation 1 of a.jpg: box 60, 40, 60, 43 has no area"),
        (changed("annotations", 0, bbox=[60, 40, -5, 3]), r"annotation 1 of a.jpg: .* has no area"),
        (changed("annotations", 0, bbox=[1, 2, float("nan"), 3]), r"annotation 1 of a.jpg: .* has no area"),
        (changed("annotations", 0, bbox=[1, 2, 3]), r"annotations\[0\]: bbox should be 4 numbers, not \[1, 2, 3\]"),
        (changed("annotations", 0, bbox=None), r"bbox should be 4 numbers, not None"),
        (changed("images", 1, id=7), r"images: two have the same id"),
        (changed("images", 1, width=0), r"images\[1\]: has no area"),
        (changed("images", 1, file_name="c.jpg"), r"image c.jpg is missing \(looked in .*images\)"),
        (changed("images", 0, file_name="c.jpg"), r"image c.jpg is missing \(looked in "),
        (coco(images={}), r"images: is missing or no list"),
        (coco(annotations=[4]), r"annotations\[0\]: should hold keys and values"),
        (coco(annotations=[{"id": 1}]), r"annotations\[0\]: key 'image_id' is missing"),
        ([], r"should hold images, annotations and categories"),
    ],
)
def test_a_fault_is_told_in_one_line_with_its_place(tmp_path: Path, document: object, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        open_dataset(write_coco(tmp_path, document))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (json.dumps(coco())[:200].encode(), r"annotations.json:1: is not JSON: .* \(is the file cut off\?\)"),
        (b"", "is not JSON"),
        (b'{"a": "\xff"}', "is not UTF-8 text"),
        (b"[" * 100_000, "is nested too deeply|is not JSON"),
    ],
)
def test_a_corrupt_file_is_told(tmp_path: Path, content: bytes, message: str) -> None:
    (tmp_path / "annotations.json").write_bytes(content)
    with pytest.raises(InputError, match=message):
        open_dataset(tmp_path)


def test_what_is_no_data_set_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such data set"):
        open_dataset(tmp_path / "nothing")
    with pytest.raises(InputError, match="is no data set"):
        open_dataset(tmp_path)
