"""`zavis matcher`, from data to a judged model."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

pytest.importorskip("torch")

from sim.labelled_frames import FrameRecipe, write_frames
from zavis_bt.cli.matcher import app
from zavis_bt.errors import InputError
from zavis_bt.perception.clip.loading import CONFIG


def matcher(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments))


def test_train_and_judge(tmp_path: Path) -> None:
    data, out = str(tmp_path / "data"), str(tmp_path / "model")
    list(write_frames(tmp_path / "data", 4, FrameRecipe(seed=5, width=160, least_side=4.0)))
    short = ("--steps", "2", "--batch", "4")
    result = matcher("train", data, "--out", out, *short)
    assert result.exit_code == 0, result.exception
    facts = json.loads((tmp_path / "model" / CONFIG).read_text())["training"]
    assert facts["trained_on"] == "rendered pixels"
    assert facts["steps"] == 2
    again = matcher("train", data, "--out", out, *short)
    assert isinstance(again.exception, InputError)
    assert "holds a training (go on with --resume" in str(again.exception)
    longer = matcher("train", data, "--out", out, "--steps", "3", "--batch", "4", "--resume")
    assert longer.exit_code == 0, longer.exception
    judged = matcher("eval", out, data, "--json")
    assert judged.exit_code == 0, judged.exception
    content = json.loads(judged.output)
    assert content["trained_on"] == "rendered pixels"
    assert 0 <= content["figures"]["category, all crops"] <= 1
    wider = matcher("widen", out, "--width", "40", "--out", str(tmp_path / "wider"))
    assert wider.exit_code == 0, wider.exception
    facts = json.loads((tmp_path / "wider" / CONFIG).read_text())
    assert facts["model_cfg"]["vision_cfg"]["width"] == facts["training"]["widened_to"] == 40
    deeper = matcher("deepen", out, "--layers", "2,3,3,2", "--out", str(tmp_path / "deeper"))
    assert deeper.exit_code == 0, deeper.exception
    facts = json.loads((tmp_path / "deeper" / CONFIG).read_text())
    assert facts["model_cfg"]["vision_cfg"]["layers"] == facts["training"]["deepened_to"] == [2, 3, 3, 2]
    mean = matcher("average", "zavis-tiny", out, "--out", str(tmp_path / "mean"))
    assert mean.exit_code == 0, mean.exception
    assert matcher("eval", str(tmp_path / "mean"), data).exit_code == 0
    printed = matcher("eval", "zavis-tiny", data)
    assert "(trained on: rendered pixels)" in printed.output


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("train", "nowhere", "--out", "x"), "there is no such data set"),
        (("train", "sim:none", "--out", "x"), "is no number of drawn images"),
        (("train", "sim:4", "--out", "x", "--device", "tpu"), "'tpu' is unknown"),
        (("train", "sim:4", "--out", "x", "--resume"), "holds no training"),
        (("widen", "zavis-tiny", "--width", "8", "--out", "x"), "an even number above"),
        (("deepen", "zavis-tiny", "--layers", "1,1", "--out", "x"), "none below these"),
        (("deepen", "zavis-tiny", "--layers", "more", "--out", "x"), "--layers: 'more' are no whole numbers"),
        (("average", "zavis-tiny", "--out", "x"), "name two or more"),
        (("eval", "nonsense", "sim:4"), "is unknown"),
        (("eval", "ViT-B-32@nowhere.pt", "sim:4"), "neither a file nor a published tag"),
    ],
)
def test_faults_are_told_in_one_line(arguments: tuple[str, ...], told: str) -> None:
    error = matcher(*arguments).exception
    assert isinstance(error, InputError)
    assert told in str(error)
    assert "\n" not in str(error)
