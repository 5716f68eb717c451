from __future__ import annotations

import cv2
import numpy as np
import pytest

from drivers.camera.stills import stills
from zavis_bt.errors import InputError


@pytest.fixture
def folders(tmp_path):
    """Folders of three grey images each, which say their number on the left and on the right."""
    for eye, shade in (("left", 10), ("right", 100)):
        (tmp_path / eye).mkdir()
        for number in range(3):
            image = np.full((16, 32, 3), shade + number, np.uint8)
            image[:, 16:] += 50
            cv2.imwrite(str(tmp_path / eye / f"{number}.png"), image)
        (tmp_path / eye / "notes.txt").write_text("no image")
    return str(tmp_path / "left"), str(tmp_path / "right")


def shades(images: list[np.ndarray]) -> list[int]:
    return [int(image[0, 0, 0]) for image in images]


def test_images_of_two_folders_belong_together_in_their_order(folders):
    found = list(stills(folders, False, 1.0))
    assert [name for name, _ in found] == ["0.png", "1.png", "2.png"]
    assert [shades(images) for _, images in found] == [[10, 100], [11, 101], [12, 102]]


def test_eyes_side_by_side_are_taken_apart(folders):
    found = list(stills(folders[:1], True, 1.0))
    assert [shades(images) for _, images in found] == [[10, 60], [11, 61], [12, 62]]
    assert all(image.shape == (16, 16, 3) for _, images in found for image in images)


def test_a_video_is_sampled_in_steps(folders):
    found = list(stills([folders[0] + "/%d.png"], False, 2 / 25))
    assert [shades(images) for _, images in found] == [[10], [12]]


def test_folders_of_unequal_length_are_no_pair(folders, tmp_path):
    (tmp_path / "right" / "2.png").unlink()
    with pytest.raises(InputError, match="hold 3 and 2 images"):
        stills(folders, False, 1.0)
