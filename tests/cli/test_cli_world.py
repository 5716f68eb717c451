from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from sim import load_world
from sim.picture import draw
from sim.sketch import sketch
from sim.worlds import builtin_world
from zavis_bt.cli.world import app
from zavis_bt.errors import InputError


@pytest.fixture
def zavis_world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> Result:
        return CliRunner().invoke(app, list(arguments))

    return run


def test_check_counts_what_is_in_good_worlds(zavis_world) -> None:
    result = zavis_world("check", "apartment", "flat")
    assert result.exit_code == 0
    assert "apartment.world.yaml: ok: 28 pieces of furniture, 43 objects, 6 starts" in result.output
    assert "flat.world.yaml: ok" in result.output


def test_check_names_all_faults_and_goes_on_to_the_next_world(zavis_world, tmp_path: Path) -> None:
    zavis_world("new", "home")
    path = tmp_path / "home.world.yaml"
    path.write_text(path.read_text().replace("on: desk_1", "on: desk").replace("[3.5, 2.5", "[0.4, 3.0"))
    result = zavis_world("check", "home.world.yaml", "nowhere", "flat")
    assert result.exit_code == 1
    assert "unknown furniture 'desk' (did you mean 'desk_1'?)" in result.output
    assert "is in an obstacle" in result.output
    assert "no built-in world 'nowhere'" in result.output
    assert "flat.world.yaml: ok" in result.output


def test_check_warns_of_what_a_wide_robot_cannot_reach(zavis_world) -> None:
    result = zavis_world("check", "apartment", "--radius", "0.6")
    assert result.exit_code == 0
    assert "warning: " in result.output


def test_new_writes_a_world_that_passes_the_check(zavis_world, tmp_path: Path) -> None:
    assert zavis_world("new", "home").exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"home.world.yaml", "home.yaml", "home.pgm"}
    assert zavis_world("check", "home").exit_code == 0
    again = zavis_world("new", "home")
    assert isinstance(again.exception, InputError)


def test_show_draws_in_the_terminal(zavis_world) -> None:
    result = zavis_world("show", "flat")
    assert result.exit_code == 0
    assert "█" in result.output
    assert "a bed_1" in result.output


def test_show_writes_a_picture(zavis_world, tmp_path: Path) -> None:
    result = zavis_world("show", "apartment", "--out", "home.png")
    assert result.exit_code == 0
    image = cv2.imread(str(tmp_path / "home.png"))
    assert max(image.shape) > 1000


def test_a_picture_that_cannot_be_written_is_an_input_error(zavis_world) -> None:
    assert isinstance(zavis_world("show", "flat", "--out", "none/home.png").exception, InputError)
    assert isinstance(zavis_world("show", "flat", "--out", "home.xyz").exception, InputError)


def test_a_sketch_keeps_to_the_width_it_is_given() -> None:
    for columns in (40, 100):
        lines = sketch(load_world(builtin_world("apartment")), columns).splitlines()
        assert max(map(len, lines)) <= columns


def test_the_picture_has_the_maps_orientation() -> None:
    world = load_world(builtin_world("flat"))
    image = draw(world, 1000)
    zoom = image.shape[0] // world.grid.shape[0]
    assert image.shape == (world.grid.shape[0] * zoom, world.grid.shape[1] * zoom, 3)
    rows, cols = np.nonzero(world.walls)
    centres = image[image.shape[0] - 1 - (rows * zoom + zoom // 2), cols * zoom + zoom // 2]
    assert (centres == (70, 70, 70)).all(axis=1).mean() > 0.95
