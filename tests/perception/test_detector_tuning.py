"""Setting above which uncertainty a thing is unknown."""

from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

torch = pytest.importorskip("torch")

from sim.labelled_frames import FrameRecipe, write_frames
from zavis_bt.cli.detector import app
from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import DetectionDataset, open_dataset
from zavis_bt.perception.detector import DetectorConfig, NeuralDetector
from zavis_bt.perception.detector.building import build_network
from zavis_bt.perception.detector.tuning import Cut, best_cut, judge_cuts
from zavis_bt.perception.evaluation import OpenSetResult, evaluate
from zavis_bt.perception.models import find_weights

CUTS = (0.3, 0.8, 0.99)


@pytest.fixture(scope="module")
def rooms(tmp_path_factory: pytest.TempPathFactory) -> DetectionDataset:
    folder = tmp_path_factory.mktemp("rooms") / "frames"
    list(write_frames(folder, 12, FrameRecipe(seed=77_002)))
    return open_dataset(folder)


def shipped() -> NeuralDetector:
    return NeuralDetector.load(find_weights("zavis-tiny-detector"))


def test_one_look_tells_what_a_look_for_each_cut_would(rooms: DetectionDataset) -> None:
    for cut in judge_cuts(shipped(), rooms, CUTS):
        one = shipped()
        one.network.config = one.network.config.with_choice(cdf=cut.cdf)
        alone = evaluate(rooms, one.detect_image, one.classes, width=one.network.config.width)
        assert cut.result.as_dict() == alone.as_dict()


def test_the_lower_the_cut_the_less_is_called_known(rooms: DetectionDataset) -> None:
    known = [
        sum(each.detections for each in cut.result.per_class) for cut in judge_cuts(shipped(), rooms, CUTS, images=6)
    ]
    assert known == sorted(known)
    assert known[0] < known[-1]


def reaching(cdf: float, k_map: float, wi: float) -> Cut:
    nothing = OpenSetResult(1, 0.0, 0.0, 0.0, 0.0, 0, 0, 0, (), ())
    return Cut(cdf, replace(nothing, k_map=k_map, wi=wi))


def test_the_best_cut_confuses_least_among_those_that_lose_little() -> None:
    judged = [reaching(0.5, 0.40, 0.10), reaching(0.8, 0.58, 0.15), reaching(0.9, 0.60, 0.20), reaching(1.0, 0.59, 0.3)]
    assert best_cut(judged, 0.0).cdf == 0.9
    assert best_cut(judged, 0.03).cdf == 0.8
    assert best_cut(judged, 1.0).cdf == 0.5


def test_images_that_show_too_little_tell_no_cut() -> None:
    with pytest.raises(InputError, match=r"wilderness impact cannot be told \(images with more things"):
        best_cut([reaching(0.9, 0.6, float("nan"))], 0.02)


def test_other_methods_have_no_cut(rooms: DetectionDataset) -> None:
    ore = NeuralDetector(build_network(DetectorConfig(("sofa",), "ore"), 0))
    with pytest.raises(InputError, match="ore has no cut of the uncertainty"):
        judge_cuts(ore, rooms)


def test_a_cut_set_by_command_is_in_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    out = tmp_path / "tuned.safetensors"
    result = CliRunner().invoke(app, ["tune", "zavis-tiny-detector", "sim:40:77002", "--out", str(out)])
    assert result.exit_code == 0, result.exception
    tuned = NeuralDetector.load(out)
    assert f"unknown above a CDF of {tuned.network.config.choice.cdf:g}" in result.output
    assert "frames-40-77002" in str(tuned.facts["cut_set_on"])
    before, after = shipped().network.state_dict(), tuned.network.state_dict()
    assert all(torch.equal(before[name], after[name]) for name in before)
