"""The detector that comes along keeps what it is said to reach, on rooms drawn anew (rendered pixels)."""

import pytest

torch = pytest.importorskip("torch")

from sim.labelled_frames import FrameRecipe, write_frames
from zavis_bt.perception.datasets import open_dataset
from zavis_bt.perception.detector import NeuralDetector
from zavis_bt.perception.evaluation import OpenSetResult, evaluate
from zavis_bt.perception.models import find_weights

FRAMES, SEED = 40, 77_001  # no training data are of this seed
K_MAP, U_RECALL, U_PRECISION, WI = 0.52, 0.50, 0.25, 0.30  # floors, and a ceiling, with a margin for so few frames


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> OpenSetResult:
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("rooms") / "frames"
    list(write_frames(folder, FRAMES, FrameRecipe(seed=SEED)))
    detector = NeuralDetector.load(find_weights("zavis-tiny-detector"))
    return evaluate(open_dataset(folder), detector.detect_image, detector.classes, width=320)


def test_known_things_are_found_and_named(result: OpenSetResult) -> None:
    assert result.k_map > K_MAP


def test_unknown_things_are_found(result: OpenSetResult) -> None:
    assert result.u_recall > U_RECALL
    assert result.u_precision > U_PRECISION


def test_unknown_things_are_seldom_taken_for_known_ones(result: OpenSetResult) -> None:
    assert result.wi < WI


def test_its_file_says_what_it_was_trained_on() -> None:
    path = find_weights("zavis-tiny-detector")
    assert path.stat().st_size < 10e6
    detector = NeuralDetector.load(path)
    assert detector.facts["rendered"] is True
    assert len(detector.classes) == 20
