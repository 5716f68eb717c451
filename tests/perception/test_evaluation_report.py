from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("torchmetrics")

from datasets_on_disk import coco, write_coco

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import DetectionDataset, open_dataset
from zavis_bt.perception.evaluation import Prediction, collect, evaluate, judge, truths_of, write_report
from zavis_bt.perception.evaluation.drawing import UNKNOWN, Mark, class_colour, draw, window
from zavis_bt.types import Box, Detection

KNOWN = ("sofa", "cup")


@pytest.fixture
def dataset(tmp_path: Path) -> DetectionDataset:
    things = [(5, [5, 5, 20, 20]), (9, [40, 5, 20, 30]), (9, [2, 30, 30, 12])]
    boxes = [{"id": k, "image_id": 7, "category_id": c, "bbox": box} for k, (c, box) in enumerate(things)]
    return open_dataset(write_coco(tmp_path / "data", coco(annotations=boxes)))


FOUND = [Prediction(0, Box(5, 5, 25, 25), "sofa", 0.9), Prediction(0, Box(40, 5, 60, 34), "cup", 0.6)]


def report(folder: Path, dataset: DetectionDataset, found: list[Prediction], **facts: object) -> str:
    result = judge(found, truths_of(dataset), KNOWN, len(dataset))
    return write_report(folder / "out", result, dataset, found, facts).read_text(encoding="utf-8")


def test_a_report_needs_nothing_from_outside(tmp_path: Path, dataset: DetectionDataset) -> None:
    page = report(tmp_path, dataset, FOUND, detector="mine")
    assert not re.search(r"https?://|<script|<link|@import|url\(", page)
    assert re.findall(r'src="([^":]*):', page) == ["data", "data", "data"]


def test_a_report_tells_figures_faults_and_facts(tmp_path: Path, dataset: DetectionDataset) -> None:
    page = report(tmp_path, dataset, FOUND, detector="mine <b>", epochs=12)
    assert "mine &lt;b&gt;" in page
    assert "<td>epochs<td>12" in page
    told = json.loads((tmp_path / "out" / "result.json").read_text())
    assert (told["a_ose"], told["u_recall"], told["facts"]["epochs"]) == (1, 0.0, 12)
    for name in ("examples", "misses", "confusions"):
        with Image.open(tmp_path / "out" / f"{name}.png") as picture:
            assert picture.width > 100


def test_rendered_pixels_are_told_of_where_facts_say_so_only(tmp_path: Path, dataset: DetectionDataset) -> None:
    assert "Trained on rendered pixels." in report(tmp_path, dataset, FOUND, rendered=True)
    assert "rendered pixels" not in report(tmp_path, dataset, FOUND, rendered=False)


def test_a_report_of_nothing_found_says_so(tmp_path: Path, dataset: DetectionDataset) -> None:
    page = report(tmp_path, dataset, [])
    assert "<p>None.</p>" in page
    assert "NaN" not in page
    assert "nan" not in page


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path, dataset: DetectionDataset) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(InputError, match="out: cannot be written"):
        report(tmp_path, dataset, FOUND)


def test_boxes_found_in_small_images_are_told_in_pixels_of_the_full_ones(dataset: DetectionDataset) -> None:
    seen = []

    def predict(rgb: np.ndarray) -> list[Detection]:
        seen.append(rgb.shape)
        return [Detection(Box(1, 2, 3, 4), "sofa", 0.5)]

    done: list[int] = []
    found = collect(dataset, predict, width=32, progress=done.append)
    assert seen == [(24, 32, 3)] * 2
    assert found == [Prediction(k, Box(2, 4, 6, 8), "sofa", 0.5) for k in range(2)]
    assert done == [1, 2]


def test_a_detector_is_judged_on_the_images_that_were_chosen(dataset: DetectionDataset) -> None:
    def predict(rgb: np.ndarray) -> list[Detection]:
        return [Detection(Box(5, 5, 25, 25), "sofa", 0.5), Detection(Box(40, 5, 60, 34), "unknown", 0.5)]

    both, empty = evaluate(dataset, predict, KNOWN), evaluate(dataset, predict, KNOWN, indices=[1])
    assert (both.images, both.u_recall, both.u_precision) == (2, 0.5, 0.5)
    assert (empty.images, empty.unknown_truths, empty.u_precision) == (1, 0, 0.0)


def test_boxes_are_drawn_where_they_are() -> None:
    image = np.asarray(draw(np.zeros((40, 60, 3), np.uint8), [Mark(Box(5, 10, 25, 30), "", (255, 0, 0))], scale=1.0))
    red = np.argwhere((image == (255, 0, 0)).all(axis=2))
    assert np.abs(red.min(axis=0) - (10, 5)).max() <= 1
    assert np.abs(red.max(axis=0) - (30, 25)).max() <= 1


def test_colours_tell_classes_apart_from_unknown() -> None:
    assert class_colour("unknown") == UNKNOWN
    assert class_colour("sofa") == class_colour("sofa") != class_colour("cup")


@pytest.mark.parametrize("box", [Box(0, 0, 640, 480), Box(630, 470, 640, 480), Box(-5, 3, 2, 4), Box(0, 200, 640, 203)])
def test_the_window_around_a_thing_lies_in_the_image(box: Box) -> None:
    x0, y0, x1, y1 = window(box, (640, 480))
    assert 0 <= x0 < x1 <= 640
    assert 0 <= y0 < y1 <= 480
    assert x1 - x0 == y1 - y0
