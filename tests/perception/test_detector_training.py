"""Training: it learns, it can be interrupted, and it refuses what cannot be learnt from."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from detector_scenes import KNOWN, write_coco_scenes, write_voc_scenes

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import open_dataset
from zavis_bt.perception.detector import (
    Checkpoint,
    ClipLabelling,
    DetectorConfig,
    NeuralDetector,
    ProposalLabelling,
    Training,
    TrainingLog,
    TrainingSettings,
    Views,
)
from zavis_bt.perception.detector.backbones import TinyBody
from zavis_bt.perception.detector.batches import Batches
from zavis_bt.perception.detector.building import build_network, export_training
from zavis_bt.perception.detector.config import BackboneName, Method
from zavis_bt.perception.detector.decoded import Decoded
from zavis_bt.perception.detector.warm_up import WarmUp, warm_up_body, warm_up_boxes

SHORT = TrainingSettings(iterations=20, batch=2, learning_rate=3e-3, save_every=7, views=Views(96, 1.5, 0.0))


@pytest.fixture(autouse=True)
def one_thread() -> None:
    torch.set_num_threads(1)


def dark(rgb: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """Take dark boxes for things, in CLIP's stead."""
    means = [rgb[int(y0) : int(y1) + 1, int(x0) : int(x1) + 1].mean() for x0, y0, x1, y1 in boxes]
    return np.array([mean < 80 for mean in means], dtype=np.float32)


def training(
    folder: Path, method: Method = "zavis", settings: TrainingSettings = SHORT, known: tuple[str, ...] = KNOWN
) -> Training:
    config = DetectorConfig(known, method, mixtures=3)
    labelling = {"zavis": ClipLabelling(dark), "ore": ProposalLabelling(), "faster_rcnn": None}[method]
    return Training(build_network(config, settings.seed), open_dataset(folder), settings, labelling)


def run(what: Training, out: Path) -> list[float]:
    """Return the total loss of each iteration."""
    out.mkdir(exist_ok=True)
    with TrainingLog(out, every=1) as log:
        what.run(log, lambda state: state.save(out))
    return [json.loads(line)["total"] for line in (out / "log.jsonl").read_text().splitlines()]


@pytest.mark.parametrize("write", [write_coco_scenes, write_voc_scenes])
def test_twenty_iterations_lower_the_loss(tmp_path: Path, write: Callable[[Path], Path]) -> None:
    losses = run(training(write(tmp_path / "data")), tmp_path / "run")
    assert len(losses) == 20
    assert np.mean(losses[-5:]) < 0.8 * losses[0]


@pytest.mark.parametrize("method", ["ore", "faster_rcnn"])
def test_the_methods_to_compare_with_learn(tmp_path: Path, method: str) -> None:
    losses = run(training(write_coco_scenes(tmp_path / "data"), method), tmp_path / "run")
    assert np.mean(losses[-5:]) < 0.8 * losses[0]


def test_an_interrupted_training_goes_on_exactly(tmp_path: Path) -> None:
    data = write_coco_scenes(tmp_path / "data")
    settings = replace(SHORT, iterations=6, save_every=3, collages_first=0.3, collages=0.3)
    whole, first = (training(data, settings=settings) for _ in range(2))
    run(whole, tmp_path / "whole")

    class Interrupted(Exception):
        pass

    def save(state: Checkpoint) -> None:
        state.save(tmp_path)
        raise Interrupted

    with TrainingLog(tmp_path) as log, pytest.raises(Interrupted):
        first.run(log, save)
    second = training(data, settings=settings)
    second.resume(Checkpoint.load(tmp_path))
    assert second.done == 3
    run(second, tmp_path / "rest")
    for name, value in whole.network.state_dict().items():
        assert torch.equal(value, second.network.state_dict()[name]), name


def test_a_training_becomes_a_detector(tmp_path: Path) -> None:
    settings = replace(SHORT, iterations=3)
    run(training(write_coco_scenes(tmp_path / "data"), settings=settings), tmp_path / "run")
    export_training(tmp_path / "run", tmp_path / "detector.safetensors", 200, {"unknown_score": 0.7})
    detector = NeuralDetector.load(tmp_path / "detector.safetensors")
    assert detector.classes == KNOWN
    assert detector.network.config.width == 200
    assert detector.network.config.choice.unknown_score == 0.7
    assert detector.network.uncertainty.count > 0


def test_a_half_training_is_not_exported(tmp_path: Path) -> None:
    started = training(write_coco_scenes(tmp_path / "data"))
    started.state().save(tmp_path)
    with pytest.raises(InputError, match=r"stopped at 0 of 20 iterations .*--resume"):
        export_training(tmp_path, tmp_path / "detector.safetensors", None, {})


def test_another_trainings_checkpoint_is_refused(tmp_path: Path) -> None:
    data = write_coco_scenes(tmp_path / "data")
    state = training(data, "ore").state()
    with pytest.raises(InputError, match="of another training"):
        training(data).resume(state)


def test_a_loss_that_is_no_number_stops_the_training(tmp_path: Path) -> None:
    broken = training(write_coco_scenes(tmp_path / "data"))
    with torch.no_grad():
        broken.network.rois.boxes.weight.fill_(torch.nan)
    with pytest.raises(InputError, match=r"loss is nan at iteration 1 .*--learning-rate"):
        run(broken, tmp_path / "run")


def test_classes_that_the_data_lack_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"has no toaster .*disc, square"):
        training(write_coco_scenes(tmp_path / "data"), known=("disc", "toaster"))


def test_data_that_show_no_known_class_are_told(tmp_path: Path) -> None:
    data = write_coco_scenes(tmp_path / "data")
    document = json.loads((data / "annotations.json").read_text())
    squares = [each for each in document["annotations"] if each["category_id"] == 2]
    (data / "annotations.json").write_text(json.dumps({**document, "annotations": squares}))
    with pytest.raises(InputError, match="no image shows a known class"):
        training(data, known=("disc",))


def test_a_corrupt_image_is_told(tmp_path: Path) -> None:
    data = write_coco_scenes(tmp_path / "data")
    for image in (data / "images").iterdir():
        image.write_bytes(b"no image")
    with pytest.raises(InputError, match=r"\.jpg"):
        run(training(data), tmp_path / "run")


@pytest.mark.parametrize("backbone", ["resnet50_fpn", "resnet50_c4"])
def test_full_size_detectors_learn_a_step_and_detect(tmp_path: Path, backbone: BackboneName) -> None:
    config = DetectorConfig(KNOWN, "zavis", backbone, width=64)
    settings = TrainingSettings(1, 1, 1e-5, views=Views(64, 1.0, 0.0))
    data = open_dataset(write_coco_scenes(tmp_path / "data", 2))
    network = build_network(config, 0)
    network.rois.samples = 4
    network.proposals._post_nms_top_n = {"training": 8, "testing": 8}  # few boxes, for speed
    learner = Training(network, data, settings, ClipLabelling(dark, start=0))
    assert all(np.isfinite(run(learner, tmp_path / "run")))
    found = NeuralDetector(learner.network).detect_image(data.image(0))
    assert all(0 <= each.score <= 1 for each in found)


def test_a_small_backbone_learns_to_tell_things_first(tmp_path: Path) -> None:
    data = open_dataset(write_coco_scenes(tmp_path / "data"))
    network = build_network(DetectorConfig(KNOWN), 0)
    assert isinstance(network.body, TinyBody)
    assert warm_up_body(network.body, network.normalised, data, KNOWN, WarmUp(30, batch=8), seed=0) > 0.8


def test_box_heads_learn_to_tell_things_without_proposals(tmp_path: Path) -> None:
    data = open_dataset(write_coco_scenes(tmp_path / "data"))
    network = build_network(DetectorConfig(KNOWN), 0)
    losses: list[float] = []
    batches = Batches(data, KNOWN, views=Views(96, mosaic=1.0, large=0.0), size=2, count=12, seed=0)
    before = {name: value.clone() for name, value in network.proposals.state_dict().items()}
    warm_up_boxes(network, batches, 2e-3, 0, lambda done, loss: losses.append(loss))
    assert np.mean(losses[-3:]) < 0.8 * losses[0]
    assert all(torch.equal(value, before[name]) for name, value in network.proposals.state_dict().items())


def test_decoded_images_are_the_data_sets(tmp_path: Path) -> None:
    data = open_dataset(write_coco_scenes(tmp_path / "data", 2))
    for _ in range(2):  # decoding, then reading
        decoded = Decoded(data, tmp_path / "images.npy", 80)
        assert decoded.annotations(1) == data.annotations(1)
        np.testing.assert_array_equal(decoded.image(1, width=80), data.image(1, width=80))
    assert decoded.image(1, width=40).shape == (30, 40, 3)
