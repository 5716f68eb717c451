"""The detector that missions use: what it returns, and what it refuses."""

import json
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from safetensors.torch import load_file, save_file

from zavis_bt.errors import InputError
from zavis_bt.perception.detector import DetectorConfig, NeuralDetector, load_detector, save_detector
from zavis_bt.perception.detector.building import build_network
from zavis_bt.perception.detector.choosing import Chosen
from zavis_bt.perception.detector.choosing import choose as choose_by
from zavis_bt.perception.detector.config import Method, method_named
from zavis_bt.perception.detector.mln import Mixture
from zavis_bt.perception.detector.network import DetectorNetwork
from zavis_bt.perception.detector.rois import Regions
from zavis_bt.types import UNKNOWN_CLASS, CameraIntrinsics, RgbdFrame

KNOWN = ("cup", "sofa", "tv")
UNKNOWN, BACKGROUND = 3, 4


def network(method: Method = "zavis", **choice: float) -> DetectorNetwork:
    config = DetectorConfig(KNOWN, method, mixtures=2)
    return build_network(config.with_choice(**choice), 0).eval()


def regions(*rows: tuple[list[float], list[float]], quality: float = 1.0) -> Regions:
    """Return boxes with the probabilities of labels on which both mixtures agree."""
    boxes, shares = (torch.tensor(each) for each in zip(*rows, strict=True))
    logits = shares.clamp(min=1e-9).log()[:, None].repeat(1, 2, 1)
    weights = torch.full((len(rows), 2), 0.5).log()
    return Regions(boxes, Mixture(logits, weights), torch.full((len(rows),), quality), torch.zeros(len(rows), 4))


def choose(boxes: Regions, made: DetectorNetwork) -> Chosen:
    return choose_by(boxes, made, made.config.choice)


SURE_CUP = [0.95, 0.01, 0.01, 0.01, 0.02]
SURE_STRANGE = [0.01, 0.01, 0.01, 0.95, 0.02]
SURE_NOTHING = [0.001, 0.001, 0.001, 0.001, 0.996]


def test_known_and_unknown_things_are_told() -> None:
    chosen = choose(
        regions(([0.0, 0, 9, 9], SURE_CUP), ([20.0, 0, 29, 9], SURE_STRANGE), ([40.0, 0, 49, 9], SURE_NOTHING)),
        network(),
    )
    assert chosen.labels.tolist() == [UNKNOWN, 0]
    assert chosen.scores.tolist() == pytest.approx([0.98, 0.95], abs=1e-5)
    torch.testing.assert_close(chosen.probabilities.sum(dim=1), torch.ones(2))


def test_uncertain_boxes_of_known_classes_become_unknown() -> None:
    made = network()
    unsure = regions(([0.0, 0, 9, 9], [0.5, 0.4, 0.05, 0.0, 0.05]))
    assert choose(unsure, made).labels.tolist() == [0]  # nothing is fitted
    made.uncertainty.add(torch.tensor([0.1, 0.2, 0.3]))
    assert choose(unsure, made).labels.tolist() == [UNKNOWN]
    assert choose(regions(([0.0, 0, 9, 9], SURE_CUP)), made).labels.tolist() == [0]


def test_plain_faster_rcnn_knows_no_unknown() -> None:
    shares = [0.5, 0.3, 0.15, 0.05]  # background is last
    assert choose(regions(([0.0, 0, 9, 9], shares)), network("faster_rcnn")).labels.tolist() == [0]


def test_one_thing_gives_one_box() -> None:
    twice = regions(
        ([0.0, 0, 20, 20], SURE_STRANGE), ([1.0, 0, 21, 20], SURE_STRANGE), ([0.0, 1, 20, 21], SURE_CUP), quality=0.5
    )
    assert choose(twice, network()).labels.tolist() == [0]


@pytest.mark.parametrize("size", [(1, 1), (7, 300), (160, 120), (8000, 6000)])
def test_images_of_any_size_are_looked_at(size: tuple[int, int]) -> None:
    detector = NeuralDetector(network(unknown_score=0.0, known_score=0.0), width=64)
    for each in detector.detect_image(np.full((size[1], size[0], 3), 90, dtype=np.uint8)):
        assert 0 <= each.box.x0 < each.box.x1 <= size[0]
        assert 0 <= each.box.y0 < each.box.y1 <= size[1]
        assert each.epistemic >= 0
        assert each.aleatoric >= 0
        if each.label == UNKNOWN_CLASS:
            assert each.probabilities == ()
        else:
            assert sum(share for _, share in each.probabilities) == pytest.approx(1)
            assert max(each.probabilities, key=lambda pair: pair[1])[0] == each.label


def test_frames_are_looked_at_once_and_alike() -> None:
    pixels = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    frame = RgbdFrame(
        CameraIntrinsics.from_fov(64, 48, 1.0), np.eye(4), 0.0, lambda: (pixels, np.ones((48, 64), np.float32))
    )
    detector = NeuralDetector(network(unknown_score=0.0, known_score=0.0))
    first = detector.detect(frame)
    assert first
    assert first == detector.detect(frame)
    assert [each.score for each in first] == sorted((each.score for each in first), reverse=True)


def test_what_is_no_image_is_refused() -> None:
    with pytest.raises(InputError, match=r"shape \(4, 4\)"):
        NeuralDetector(network()).detect_image(np.zeros((4, 4), dtype=np.uint8))


@pytest.mark.parametrize("method", ["zavis", "ore", "faster_rcnn"])
def test_a_file_holds_all_of_a_detector(tmp_path: Path, method: str) -> None:
    made = network(method, unknown_score=0.01, known_score=0.01)
    made.uncertainty.add(torch.tensor([0.5, 0.7]))
    save_detector(made, tmp_path / "d.safetensors", {"rendered": True})
    loaded, facts = load_detector(tmp_path / "d.safetensors")
    assert facts == {"rendered": True}
    assert loaded.config == made.config
    image = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    first, second = (NeuralDetector(each).detect_image(image) for each in (made, loaded))
    assert [each.label for each in first] == [each.label for each in second]
    assert [each.score for each in first] == pytest.approx([each.score for each in second], abs=1e-4)


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        NeuralDetector.load(tmp_path / "none.safetensors")


def test_a_broken_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "d.safetensors").write_bytes(b"nothing")
    with pytest.raises(InputError, match="holds no weights that can be read"):
        NeuralDetector.load(tmp_path / "d.safetensors")


def test_weights_of_something_else_are_told(tmp_path: Path) -> None:
    save_file({"a": torch.zeros(1)}, tmp_path / "d.safetensors")
    with pytest.raises(InputError, match="is no detector of this program"):
        NeuralDetector.load(tmp_path / "d.safetensors")


def test_weights_of_another_architecture_are_told(tmp_path: Path) -> None:
    save_detector(network(), tmp_path / "d.safetensors", {})
    other = DetectorConfig((*KNOWN, "bed"), mixtures=2).to_json()
    header = {"form": "zavis-detector/1", "config": other, "facts": "{}"}
    save_file(load_file(tmp_path / "d.safetensors"), tmp_path / "other.safetensors", header)
    with pytest.raises(InputError, match="do not belong to the architecture") as told:
        NeuralDetector.load(tmp_path / "other.safetensors")
    assert "\n" not in str(told.value)


def test_a_description_from_the_future_is_told() -> None:
    content = json.loads(DetectorConfig(KNOWN).to_json())
    with pytest.raises(InputError, match="unknown settings colour"):
        DetectorConfig.from_json(json.dumps({**content, "colour": 1}))


@pytest.mark.parametrize("known", [(), ("cup", "cup"), ("cup", UNKNOWN_CLASS)])
def test_classes_must_make_sense(known: tuple[str, ...]) -> None:
    with pytest.raises(InputError, match="known: needs one or more different classes"):
        DetectorConfig(known)


def test_unknown_method_is_told_with_a_proposal() -> None:
    with pytest.raises(InputError, match=r"'zavi' is unknown \(did you mean 'zavis'\?\)"):
        method_named("zavi")
