"""`zavis detector`, from data to a judged detector."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

torch = pytest.importorskip("torch")

from zavis_bt.cli.detector import app  # needs torch
from zavis_bt.errors import InputError
from zavis_bt.perception.detector import DetectorConfig, DetectorNetwork, load_detector, save_detector
from zavis_bt.perception.detector.building import build_network
from zavis_bt.perception.models import find_weights


def detector(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments))


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def test_train_export_and_judge_on_drawn_rooms(tmp_path: Path) -> None:
    run, file = str(tmp_path / "run"), str(tmp_path / "detector.safetensors")
    short = ("--method", "faster_rcnn", "--iterations", "2", "--batch", "2", "--width", "64")
    result = detector("train", "sim:24:3", "--out", run, "--known", "sofa,dining table,sink,bench,tv,oven", *short)
    assert result.exit_code == 0, result.exception
    assert len((tmp_path / "run" / "log.jsonl").read_text().splitlines()) == 0  # too short for a line
    again = detector("train", "sim:24:3", "--out", run, "--known", "sofa,dining table,sink,bench,tv,oven", *short)
    assert isinstance(again.exception, InputError)
    assert "holds a training (go on with --resume" in str(again.exception)
    assert detector("export", run, file, "--width", "64", "--known-score", "0.2").exit_code == 0
    judged = detector("eval", file, "sim:24:3", "--json", "--images", "2")
    assert judged.exit_code == 0, judged.exception
    content = json.loads(judged.output)
    assert content["images"] == 2
    assert content["facts"]["rendered"] is True
    assert content["facts"]["method"] == "faster_rcnn"


def test_a_trained_detector_is_taught_further(tmp_path: Path) -> None:
    taught = tmp_path / "run" / "detector.safetensors"
    short = ("--iterations", "1", "--batch", "2", "--width", "64", "--learning-rate", "1e-8", "--no-collages")
    result = detector("train", "sim:4:3", "--out", str(taught.parent), "--start", "zavis-tiny-detector", *short)
    assert result.exit_code == 0, result.exception
    (before, _), (after, facts) = load_detector(find_weights("zavis-tiny-detector")), load_detector(taught)
    assert after.config == before.config
    old, new = before.state_dict(), after.state_dict()
    kernels = [name for name in old if name.endswith("weight")]
    assert all(torch.allclose(old[name], new[name], atol=1e-6) for name in kernels)  # it begins where the other ended
    assert any(not torch.equal(old[name], new[name]) for name in kernels)
    assert facts["iterations"] == 1
    assert facts["start"]["weights"] == "zavis-tiny-detector"
    assert facts["start"]["rendered"] is True


@pytest.mark.parametrize("option", [("--method", "ore"), ("--known", "sofa"), ("--warm-up", "3")])
def test_a_trained_detector_brings_its_classes_and_method_along(tmp_path: Path, option: tuple[str, str]) -> None:
    error = detector("train", "sim:4:3", "--out", str(tmp_path), "--start", "zavis-tiny-detector", *option).exception
    assert isinstance(error, InputError)
    assert str(error).startswith(f"{option[0]}: zavis-tiny-detector of --start brings this along")


def a_detector(file: Path, seed: int, *known: str) -> DetectorNetwork:
    network = build_network(DetectorConfig(known), seed)
    save_detector(network, file, {"seed": seed})
    return network


def test_the_mean_of_detectors_has_the_mean_of_their_weights(tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("one.safetensors", "two.safetensors", "mean.safetensors")]
    one, two = (a_detector(file, seed, "sofa", "sink").state_dict() for seed, file in enumerate(files[:2]))
    result = detector("average", *map(str, files[:2]), "--out", str(files[2]))
    assert result.exit_code == 0, result.exception
    mean, facts = load_detector(files[2])
    for name, value in mean.state_dict().items():
        torch.testing.assert_close(value, (one[name] + two[name]) / 2 if value.is_floating_point() else two[name])
    assert facts == {"seed": 1, "average_of": 2}


def test_detectors_of_other_classes_have_no_mean(tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("one.safetensors", "two.safetensors")]
    a_detector(files[0], 0, "sofa", "sink")
    a_detector(files[1], 0, "sink", "sofa")
    error = detector("average", *map(str, files), "--out", str(tmp_path / "mean.safetensors")).exception
    assert isinstance(error, InputError)
    assert "differ in method or classes" in str(error)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("train", "sim:none", "--out", "x"), "is no number of drawn images"),
        (("train", "sim:4", "--out", "x", "--method", "yolo"), "'yolo' is unknown"),
        (("train", "sim:4", "--out", "x", "--device", "tpu"), "'tpu' is unknown (cpu or cuda)"),
        (("train", "nowhere", "--out", "x"), "there is no such data set"),
        (("export", "nowhere", "x.safetensors"), "holds no training"),
        (("average", "zavis-tiny-detector", "-o", "x.safetensors"), "name two or more"),
        (("average", "zavis-tiny-detector", "-o", "x.pt"), "needs to end in .safetensors"),
        (("export", "nowhere", "x.pt"), "needs to end in .safetensors"),
    ],
)
def test_faults_are_told_in_one_line(arguments: tuple[str, ...], told: str) -> None:
    error = detector(*arguments).exception
    assert isinstance(error, InputError)
    assert told in str(error)
    assert "\n" not in str(error)
