from __future__ import annotations

from pathlib import Path

import pytest
from datasets_on_disk import thing, write_voc

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import Annotation, open_dataset, project_name
from zavis_bt.types import Box


def test_pixels_counted_from_one_become_edges_counted_from_zero(tmp_path: Path) -> None:
    write_voc(tmp_path, "000005", thing("chair", (1, 1, 64, 48)) + thing("diningtable", (11, 21, 40, 35.5)))
    dataset = open_dataset(tmp_path)
    assert dataset.annotations(0) == (
        Annotation(Box(0, 0, 64, 48), "chair"),
        Annotation(Box(10, 20, 40, 35.5), "dining table"),
    )


def test_difficult_things_are_ignored(tmp_path: Path) -> None:
    write_voc(tmp_path, "a", thing("chair", (1, 1, 9, 9), 1) + thing("sofa", (1, 1, 9, 9)))
    assert [a.ignored for a in open_dataset(tmp_path).annotations(0)] == [True, False]


def test_a_split_names_its_images_in_its_order(tmp_path: Path) -> None:
    for name in "abc":
        write_voc(tmp_path, name, thing(f"thing {name}", (1, 1, 9, 9)))
    (tmp_path / "ImageSets" / "Main").mkdir(parents=True)
    (tmp_path / "ImageSets" / "Main" / "val.txt").write_text("c  1\na -1\n\n")
    dataset = open_dataset(f"{tmp_path}:val")
    assert [dataset.annotations(i)[0].category for i in range(len(dataset))] == ["thing c", "thing a"]
    assert len(open_dataset(tmp_path)) == 3
    with pytest.raises(InputError, match=r"has no list test.txt \(one of: val\)"):
        open_dataset(f"{tmp_path}:test")


def test_a_size_that_is_not_told_is_taken_from_the_image(tmp_path: Path) -> None:
    write_voc(tmp_path, "a", thing("chair", (1, 1, 9, 9)), size="<size><width>0</width><height>0</height></size>")
    assert open_dataset(tmp_path).size(0) == (64, 48)


@pytest.mark.parametrize(
    ("things", "message"),
    [
        ("", "holds no boxes"),
        (thing("", (1, 1, 9, 9)), r"a.xml: object 1: has no name"),
        (thing("cup", (1, 1, 9, 9)) + thing("cup", (1, 1, 90, 9)), r"a.xml: object 2: box 0, 0, 90, 9 reaches out"),
        (thing("cup", (9, 1, 5, 9)), r"a.xml: object 1: .* has no area"),
        (thing("cup", ("x", 1, 5, 9)), r"a.xml: object 1: bndbox should have numbers"),
        ("<object><name>cup</name></object>", r"a.xml: object 1: bndbox should have numbers"),
        ("<object>", r"a.xml: is not XML"),
    ],
)
def test_a_fault_is_told_with_file_and_object(tmp_path: Path, things: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        open_dataset(write_voc(tmp_path, "a", things))


def test_missing_images_and_annotations_are_told(tmp_path: Path) -> None:
    write_voc(tmp_path, "a", thing("cup", (1, 1, 9, 9)))
    (tmp_path / "ImageSets" / "Main").mkdir(parents=True)
    (tmp_path / "ImageSets" / "Main" / "val.txt").write_text("a\nb\n")
    with pytest.raises(InputError, match=r"image b.jpg is missing \(looked in .*JPEGImages\)"):
        open_dataset(f"{tmp_path}:val")
    (tmp_path / "JPEGImages" / "b.jpg").write_bytes(b"")
    with pytest.raises(InputError, match=r"b.xml: cannot be read"):
        open_dataset(f"{tmp_path}:val")


@pytest.mark.parametrize(
    ("theirs", "ours"),
    [
        ("diningtable", "dining table"),
        ("tvmonitor", "tv"),
        ("pottedplant", "plant"),
        ("potted plant", "plant"),
        ("couch", "sofa"),
        ("Refrigerator", "fridge"),
        ("washing machine", "washing machine"),
        ("hair drier", "hair drier"),
    ],
)
def test_names_of_voc_and_coco_meet_the_projects(theirs: str, ours: str) -> None:
    assert project_name(theirs) == ours
