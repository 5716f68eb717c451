from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cv2
import numpy as np
import pytest
from datasets_on_disk import coco, write_coco, write_picture
from PIL import Image

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import open_dataset
from zavis_bt.perception.datasets.pictures import read_picture


def test_an_image_is_rgb(tmp_path: Path) -> None:
    rgb = open_dataset(write_coco(tmp_path)).image(0)
    assert rgb.shape == (48, 64, 3)
    assert rgb.dtype == np.uint8
    red, green, blue = (rgb[24, 60].astype(float), rgb[44, 32].astype(float), rgb[..., 2])
    assert red[0] > 220
    assert green[1] > 220
    assert abs(float(blue.mean()) - 200) < 8


@pytest.mark.parametrize("width", [320, 300, 160, 81, 80, 33, 1])
def test_scaling_down_shows_the_same_picture(tmp_path: Path, width: int) -> None:
    write_picture(tmp_path / "a.jpg", (641, 479))
    full, small = (read_picture(tmp_path / "a.jpg", (641, 479), w) for w in (None, width))
    assert small.shape == (max(round(479 * width / 641), 1), width, 3)
    reference = cv2.resize(full, small.shape[1::-1], interpolation=cv2.INTER_AREA)
    assert np.abs(small.astype(int) - reference).mean() < 3


def test_an_image_is_never_scaled_up(tmp_path: Path) -> None:
    assert open_dataset(write_coco(tmp_path)).image(0, width=640).shape == (48, 64, 3)


def test_threads_may_read_at_once(tmp_path: Path) -> None:
    dataset = open_dataset(write_coco(tmp_path))
    with ThreadPoolExecutor(4) as pool:
        images = list(pool.map(lambda k: dataset.image(k % 2, width=16), range(40)))
    assert all(np.array_equal(image, images[k % 2]) for k, image in enumerate(images))


def test_a_turned_photograph_is_shown_as_its_boxes_were_drawn(tmp_path: Path) -> None:
    turned = Image.Exif()
    turned[0x0112] = 6  # to be shown a quarter turn to the right
    Image.fromarray(np.zeros((48, 64, 3), np.uint8)).save(tmp_path / "a.jpg", exif=turned)
    assert read_picture(tmp_path / "a.jpg", (64, 48)).shape == (48, 64, 3)
    assert read_picture(tmp_path / "a.jpg", (48, 64)).shape == (64, 48, 3)


def test_a_grey_image_becomes_rgb(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.full((5, 7), 9, np.uint8))
    assert (read_picture(tmp_path / "a.png", (7, 5)) == 9).all()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "a.jpg: is no image, or a corrupt one"),
        (b"text", "a.jpg: is no image, or a corrupt one"),
        (b"\xff\xd8 and no more", "a.jpg: is a cut-off JPEG file"),
        (None, "a.jpg: cannot be read: No such file"),
    ],
)
def test_a_file_that_is_no_image_is_told(tmp_path: Path, content: bytes | None, message: str) -> None:
    dataset = open_dataset(write_coco(tmp_path))
    file = tmp_path / "images" / "a.jpg"
    file.unlink()
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(InputError, match=message):
        dataset.image(0)


def test_a_cut_off_jpeg_is_told_instead_of_shown_half_grey(tmp_path: Path) -> None:
    dataset = open_dataset(write_coco(tmp_path))
    file = tmp_path / "images" / "a.jpg"
    file.write_bytes(file.read_bytes()[:-200])
    with pytest.raises(InputError, match="is a cut-off JPEG file"):
        dataset.image(0)


def test_an_image_of_another_size_is_told(tmp_path: Path) -> None:
    document = coco()
    document["images"][0] |= {"width": 128, "height": 96}
    dataset = open_dataset(write_coco(tmp_path, document))
    for width in (None, 32):
        with pytest.raises(InputError, match="is 64×48 px, but the data set says 128×96"):
            dataset.image(0, width=width)


def test_data_sets_need_no_torch() -> None:
    script = (
        "import sys; import zavis_bt.perception.datasets, zavis_bt.perception.evaluation; print('torch' in sys.modules)"
    )
    assert subprocess.check_output([sys.executable, "-c", script], text=True).strip() == "False"
