"""Collages of known things, and when they are learnt from."""

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from detector_scenes import KNOWN, write_coco_scenes

from zavis_bt.perception.datasets import DetectionDataset, open_dataset
from zavis_bt.perception.detector.batches import Batches, Views
from zavis_bt.perception.detector.collages import Collages
from zavis_bt.perception.detector.course import Course


@pytest.fixture
def scenes(tmp_path: Path) -> DetectionDataset:
    return open_dataset(write_coco_scenes(tmp_path / "data", 8))


def collages(scenes: DetectionDataset, known: tuple[str, ...] = KNOWN, seed: int = 0) -> Collages:
    return Collages(scenes, known, width=160, size=3, seed=seed)


def course(scenes: DetectionDataset, first: int, share: float, known: tuple[str, ...] = KNOWN) -> Course:
    views = Batches(scenes, KNOWN, views=Views(96, 1.0, 0.0), size=2, count=20, seed=0)
    return Course(views, collages(scenes, known), first=first, share=share, seed=0)


def test_boxes_lie_on_what_is_pasted(scenes: DetectionDataset) -> None:
    images, targets = collages(scenes)[0]
    assert images.shape == (3, 3, 120, 160)
    for image, target in zip(images, targets, strict=True):
        assert len(target.boxes) >= 4
        for (x0, y0, x1, y1), label in zip(target.boxes.tolist(), target.labels.tolist(), strict=True):
            assert 0 <= x0 < x1 <= 160.5
            assert 0 <= y0 < y1 <= 120.5
            middle = image[:, int((y0 + y1) / 2), int((x0 + x1) / 2)]
            red_less_blue = float(middle[0] - middle[2])
            assert (red_less_blue > 0.4) == (label == KNOWN.index("disc"))  # discs are yellow, squares dark


def test_the_same_number_is_the_same_batch(scenes: DetectionDataset) -> None:
    first, second, other = collages(scenes)[4], collages(scenes)[4], collages(scenes, seed=1)[4]
    assert torch.equal(first[0], second[0])
    assert all(torch.equal(a.boxes, b.boxes) for a, b in zip(first[1], second[1], strict=True))
    assert not torch.equal(first[0], other[0])


def test_patches_are_of_the_known_classes(scenes: DetectionDataset) -> None:
    named = [thing.category for k in range(len(scenes)) for thing in scenes.annotations(k)]
    assert len(collages(scenes)) == len(named)
    assert len(collages(scenes, ("disc",))) == named.count("disc")


def test_collages_come_first_and_then_now_and_then(scenes: DetectionDataset) -> None:
    kinds = [is_collage for *_, is_collage in (course(scenes, 5, 0.4)[k] for k in range(20))]
    assert all(kinds[:5])
    assert 1 <= sum(kinds[5:]) <= 12


def test_without_collages_all_batches_are_views(scenes: DetectionDataset) -> None:
    assert not any(course(scenes, 0, 0.0)[k][2] for k in range(6))
    assert not any(course(scenes, 6, 1.0, known=("lamp",))[k][2] for k in range(6))  # nothing to paste


def test_views_are_the_same_with_and_without_collages(scenes: DetectionDataset) -> None:
    mixed, plain = course(scenes, 2, 0.0), course(scenes, 0, 0.0)
    np.testing.assert_array_equal(mixed[3][0].numpy(), plain[3][0].numpy())
