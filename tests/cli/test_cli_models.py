from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import save_file
from typer.testing import CliRunner, Result

from zavis_bt.cli.models import app
from zavis_bt.errors import InputError

LIBRARIES = ("torch", "torchvision", "open_clip", "transformers", "torchmetrics", "huggingface_hub", "pycocotools")


@pytest.fixture
def zavis_models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("ZAVIS_MODELS", str(tmp_path / "models"))
    monkeypatch.setenv("COLUMNS", "120")

    def run(*arguments: str) -> Result:
        return CliRunner().invoke(app, list(arguments))

    return run


@pytest.fixture
def weights(tmp_path: Path) -> Path:
    save_file({"w": np.arange(1000.0)}, tmp_path / "mine.safetensors")
    return tmp_path / "mine.safetensors"


def test_list_names_what_is_missing_with_its_size(zavis_models) -> None:
    lines = zavis_models("list").output.splitlines()
    line = next(line for line in lines if line.strip().startswith("vit-b-32-laion2b"))
    assert "missing" in line
    assert "605 MB" in line
    assert "MIT" in line


def test_list_says_that_ours_were_trained_on_rendered_pixels(zavis_models) -> None:
    models = json.loads(zavis_models("list", "--json").output)["models"]
    ours = [model for model in models if model["name"].startswith("zavis-tiny")]
    assert len(ours) == 2
    assert all(model["trained_on"] == "rendered pixels" for model in ours)


def test_added_models_are_listed_and_checked(zavis_models, weights: Path, tmp_path: Path) -> None:
    result = zavis_models("add", "mine", str(weights))
    assert result.exit_code == 0, result.output
    assert f"mine: added to {tmp_path}/models/mine/mine.safetensors" in result.output
    assert "your own" in zavis_models("list").output
    assert "mine: ok" in zavis_models("check", "mine").output


def test_check_finds_damage_and_fails(zavis_models, weights: Path, tmp_path: Path) -> None:
    zavis_models("add", "mine", str(weights))
    path = tmp_path / "models" / "mine" / "mine.safetensors"
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    result = zavis_models("check", "mine")
    assert result.exit_code == 1
    assert "SHA-256" in result.output


def test_check_of_what_is_not_here_says_so(zavis_models) -> None:
    result = zavis_models("check", "comet")
    assert isinstance(result.exception, InputError)
    assert "not on this machine: comet" in str(result.exception)


def test_add_refuses_what_is_no_model(zavis_models, tmp_path: Path) -> None:
    (tmp_path / "page.pt").write_text("<html>log in first</html>")
    result = zavis_models("add", "mine", str(tmp_path / "page.pt"))
    assert isinstance(result.exception, InputError)
    assert "web page" in str(result.exception)


def test_nothing_simulated_loads_a_network(tmp_path: Path) -> None:
    """The command line with all its commands and a mission in simulation do without torch and what hangs on it."""
    script = f"""
import sys
import zavis_bt.perception, zavis_bt.perception.datasets, zavis_bt.perception.evaluation, zavis_bt.perception.models
from zavis_bt.cli.main import app
try:
    app(["run", "search", "--target", "mug", "--json", "--max-seconds", "10", "--record", {str(tmp_path / "run")!r}])
except SystemExit as ended:
    assert ended.code in (0, 4), ended.code
sys.exit(", ".join(name for name in {LIBRARIES!r} if name in sys.modules) or 0)
"""
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert ended.returncode == 0, ended.stderr
    assert json.loads(ended.stdout)["method"] == "search"
