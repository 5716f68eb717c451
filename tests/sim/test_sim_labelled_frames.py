from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.appearance import SHAPES, THINGS
from sim.labelled_frames import FrameRecipe, chosen_categories, frames_of_room, labels_in, write_frames
from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import open_dataset

RECIPE = FrameRecipe(seed=5, width=96)


def test_what_is_written_opens_as_a_data_set(tmp_path: Path) -> None:
    assert list(write_frames(tmp_path / "new", 6, RECIPE)) == [4, 6]
    dataset = open_dataset(tmp_path / "new")
    assert len(dataset) == 6
    assert dataset.rendered
    assert dataset.categories == tuple(SHAPES)
    for index in range(6):
        assert dataset.size(index) == (96, 72)
        assert dataset.image(index).shape == (72, 96, 3)


def test_a_shorter_data_set_of_a_seed_is_the_beginning_of_a_longer_one(tmp_path: Path) -> None:
    for count in (2, 5):
        assert list(write_frames(tmp_path / str(count), count, RECIPE))
    short, long = (open_dataset(tmp_path / str(count)) for count in (2, 5))
    for index in range(2):
        assert np.array_equal(short.image(index), long.image(index))
        assert short.annotations(index) == long.annotations(index)


def test_labels_tell_what_the_frame_shows(tmp_path: Path) -> None:
    assert list(write_frames(tmp_path / "new", 4, RECIPE))
    written = json.loads((tmp_path / "new" / "annotations.json").read_text())["annotations"]
    shown = [label for frame, _ in frames_of_room(RECIPE, 0) for label in labels_in(frame)]
    assert len(written) == len(shown)
    for record, label in zip(written, shown, strict=True):
        x, y, width, height = record["bbox"]
        assert (x, y, x + width, y + height) == tuple(label.box)
        assert record["colour"] == label.colour
        small = min(width, height) < RECIPE.least_side or label.visible_fraction < RECIPE.least_visible
        assert record["iscrowd"] == int(small)


def test_what_the_border_cuts_off_is_not_in_sight() -> None:
    for frame, _ in frames_of_room(RECIPE, 1):
        whole = {view.id: view.full_box for view in frame.instances}
        seen = {label.id: label.visible_fraction for label in frame.labels}
        for label in labels_in(frame):
            width, height = frame.intrinsics.width, frame.intrinsics.height
            box = whole.get(label.id, label.box)
            if box.x0 >= 0 and box.y0 >= 0 and box.x1 <= width and box.y1 <= height:
                assert label.visible_fraction == pytest.approx(seen[label.id])
            else:
                assert label.visible_fraction < seen[label.id]


def test_categories_left_out_are_never_drawn() -> None:
    few = chosen_categories(without=[name for name in SHAPES if name not in ("sofa", "mug", "desk")], also=["mug"])
    assert few == ("sofa", "desk", "mug", "mug")
    labels = [label for frame, _ in frames_of_room(FrameRecipe(width=64, categories=few), 0) for label in frame.labels]
    assert {label.category for label in labels} & set(SHAPES) <= set(few)
    assert chosen_categories() == THINGS


@pytest.mark.parametrize(
    ("without", "also", "message"),
    [
        (["mgu"], [], r"no category 'mgu' \(did you mean 'mug'\?\)"),
        (["mug"], ["mug"], "'mug' cannot be left out and drawn more often"),
        (list(SHAPES), [], "no category is left"),
    ],
)
def test_categories_that_make_no_sense_are_told(without: list[str], also: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        chosen_categories(without, also)


def test_a_folder_that_holds_something_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("precious")
    with pytest.raises(InputError, match="is not empty"):
        list(write_frames(tmp_path, 1, RECIPE))
    with pytest.raises(InputError, match="cannot be made"):
        list(write_frames(tmp_path / "mine.txt", 1, RECIPE))
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_an_image_that_cannot_be_written_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cv2, "imwrite", lambda *_: False)  # as on a full disk
    with pytest.raises(InputError, match=r"000000.jpg: cannot be written \(is the disk full\?\)"):
        list(write_frames(tmp_path / "new", 1, RECIPE))
    assert not (tmp_path / "new" / "annotations.json").exists()


@pytest.mark.parametrize(
    ("recipe", "count", "message"),
    [
        (FrameRecipe(width=8), 1, "1 images of width 8"),
        (RECIPE, 0, "0 images"),
        (FrameRecipe(categories=("mug", "unicorn")), 1, "no category unicorn"),
        (FrameRecipe(distance=(4.0, 1.0)), 1, "distances of 4 to 1 m"),
    ],
)
def test_a_recipe_out_of_range_is_told(tmp_path: Path, recipe: FrameRecipe, count: int, message: str) -> None:
    with pytest.raises(InputError, match=message):
        list(write_frames(tmp_path / "new", count, recipe))
