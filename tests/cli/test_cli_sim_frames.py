from __future__ import annotations

from pathlib import Path

from typer.testing import CliRunner, Result

from zavis_bt.cli.sim import app
from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import open_dataset


def frames(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["frames", *arguments])


def test_frames_are_drawn_with_labels(tmp_path: Path) -> None:
    result = frames(str(tmp_path / "new"), "-n", "3", "--width", "64", "--without", "kettle", "--also", "cup")
    assert result.exit_code == 0
    assert result.output.strip().endswith("new: 3 images of 131 categories")
    assert len(open_dataset(tmp_path / "new")) == 3


def test_several_processes_draw_the_same(tmp_path: Path) -> None:
    for workers in ("1", "2"):
        assert frames(str(tmp_path / workers), "-n", "6", "--width", "48", "-j", workers).exit_code == 0
    one, two = ((tmp_path / workers / "annotations.json").read_text() for workers in "12")
    assert one == two


def test_a_category_that_is_not_there_is_told(tmp_path: Path) -> None:
    result = frames(str(tmp_path / "new"), "--without", "kettel")
    assert isinstance(result.exception, InputError)
    assert "did you mean 'kettle'?" in str(result.exception)
