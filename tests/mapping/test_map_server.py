from __future__ import annotations

import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from zavis_bt.errors import InputError
from zavis_bt.mapping import load_map, save_map
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, GridMap

YAML = """image: room.pgm
resolution: 0.05
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""
STATES = arrays(np.int8, array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.sampled_from([-1, 0, 100]))
COORDINATES = st.floats(-1e4, 1e4)


def write(folder: Path, yaml: str = YAML, image: bytes = b"P5\n2 1\n255\n\xfe\x00") -> Path:
    (folder / "room.pgm").write_bytes(image)
    (folder / "room.yaml").write_text(yaml)
    return folder / "room.yaml"


@given(states=STATES, resolution=st.floats(1e-3, 10), x=COORDINATES, y=COORDINATES)
def test_a_saved_map_is_loaded_unchanged(
    tmp_path_factory: pytest.TempPathFactory, states: np.ndarray, resolution: float, x: float, y: float
) -> None:
    path = tmp_path_factory.mktemp("map") / 'a "quoted" name.yaml'
    save_map(path, GridMap(states, resolution, (x, y)))
    loaded = load_map(path)
    np.testing.assert_array_equal(loaded.states, states)
    assert (loaded.resolution, loaded.origin) == (resolution, (x, y))


def test_the_images_first_row_is_the_largest_y(tmp_path: Path) -> None:
    grid = load_map(write(tmp_path, image=b"P5\n1 3\n255\n\xfe\x00\xcd"))
    assert grid.states[:, 0].tolist() == [UNKNOWN, OCCUPIED, FREE]
    assert grid.state_at(-0.99, 2.12) == FREE


def test_loaded_states_are_read_only(tmp_path: Path) -> None:
    assert not load_map(write(tmp_path)).states.flags.writeable


def test_negate_makes_white_occupied(tmp_path: Path) -> None:
    grid = load_map(write(tmp_path, YAML.replace("negate: 0", "negate: 1")))
    assert grid.states.tolist() == [[OCCUPIED, FREE]]


@pytest.mark.parametrize(
    "image",
    [
        b"P2\n# a comment\n2 1\n255\n254 # white\n0\n",
        b"P5 # one\n2 1 # two\n15\n\x0f\x00",
        b"P5\n2 1\n65535\n\xff\xfe\x00\x10",
    ],
)
def test_other_greymaps_mean_the_same(tmp_path: Path, image: bytes) -> None:
    assert load_map(write(tmp_path, image=image)).states.tolist() == [[FREE, OCCUPIED]]


def test_png_images_mean_the_same(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "room.png"), np.array([[254, 0, 205]], dtype=np.uint8))
    grid = load_map(write(tmp_path, YAML.replace("room.pgm", "room.png")))
    assert grid.states.tolist() == [[FREE, OCCUPIED, UNKNOWN]]


@pytest.mark.parametrize(
    ("yaml", "image", "message"),
    [
        (YAML.replace("room.pgm", "hall.pgm"), b"", r"hall\.pgm: no such file"),
        (YAML, b"GIF89a", r"room\.pgm: not a PGM image"),
        (YAML, b"P5\n2 2\n255\n\x00\x00\x00", r"room\.pgm: cut off after 3 of 4 pixels"),
        (YAML, b"P2\n2 2\n255\n1 2 3", r"cut off after 3 of 4 pixels"),
        (YAML, b"P2\n2 1\n255\n1 x", r"numbers from 0 to 65535"),
        (YAML, b"P2\n2 1\n255\n1 70000", r"numbers from 0 to 65535"),
        (YAML, b"P5\n2 1\n15\n\x10\x00", r"a pixel of 16 is brighter than white \(15\)"),
        (YAML, b"P5\n0 1\n255\n", r"0 × 1 pixels"),
        (YAML.replace("room.pgm", "room.yaml"), b"", r"room\.yaml: not an image"),
        (YAML.replace("resolution: 0.05\n", ""), b"", r"room\.yaml:1: key 'resolution' is missing"),
        (YAML.replace("0.05", "-0.05"), b"", r"room\.yaml:2: resolution: .*greater than 0, not -0\.05"),
        (YAML.replace("0.05", ".nan"), b"", r"room\.yaml:2: resolution: should be a finite number"),
        (YAML.replace("2.0, 0.0]", "2.0, 1.57]"), b"", r"origin is rotated by 1\.57 rad"),
        (YAML.replace("[-1.0, 2.0, 0.0]", "[-1.0]"), b"", r"room\.yaml:3: key 'origin\[1\]' is missing"),
        (YAML.replace("0.196", "0.9"), b"", r"free_thresh 0\.9 must be below occupied_thresh 0\.65"),
        (YAML + "mode: raw\n", b"", r"room\.yaml:7: mode: .*'trinary'"),
        (YAML + "colour: red\n", b"", r"room\.yaml:7: unknown key 'colour' \(one of: free_thresh, image"),
        ("- 1\n", b"", r"room\.yaml:1: should hold keys and values \(image, resolution"),
        ("image: [", b"", r"room\.yaml:1: is not YAML"),
    ],
)
def test_a_wrong_file_is_explained_in_one_line(tmp_path: Path, yaml: str, image: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        load_map(write(tmp_path, yaml, image))
    assert str(caught.value).startswith(str(tmp_path))
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=re.escape(f"{tmp_path / 'none.yaml'}: no such file")):
        load_map(tmp_path / "none.yaml")


def test_a_folder_that_is_missing_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot be written: No such file"):
        save_map(tmp_path / "none" / "map.yaml", GridMap(np.zeros((1, 1), np.int8), 0.05, (0.0, 0.0)))


def test_real_maps_load(shared: Path) -> None:
    for path in sorted((shared / "worlds" / "ithor").glob("FloorPlan*[0-9].yaml")):
        grid = load_map(path)
        assert grid.resolution == 0.05
        assert {FREE, OCCUPIED} <= set(np.unique(grid.states).tolist())
