from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

torch = pytest.importorskip("torch")
open_clip = pytest.importorskip("open_clip")

from safetensors.torch import save_file

from sim.camera import SimCamera
from sim.scene import Scene
from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.cli.main import app
from zavis_bt.errors import InputError
from zavis_bt.perception import (
    DEFAULT_KNOWN_LANDMARKS,
    DEFAULT_UNKNOWN_LANDMARKS,
    EyesSettings,
    Perceiver,
    Thresholds,
    open_eyes,
    split_landmarks,
)
from zavis_bt.perception.detector import DetectorConfig, save_detector
from zavis_bt.perception.detector.building import build_network
from zavis_bt.perception.eyes_file import read_eyes, write_eyes
from zavis_bt.perception.models import WEIGHTS
from zavis_bt.perception.neural import checksum
from zavis_bt.types import CameraIntrinsics, CameraSpec

CLASSES = ("chair", "sofa", "dining table", "tv")
CLIP = {
    "embed_dim": 16,
    "vision_cfg": {"image_size": 32, "layers": [1, 1, 1, 1], "width": 8},
    "text_cfg": {"context_length": 16, "vocab_size": 49408, "width": 8, "heads": 2, "layers": 1},
}
ANYTHING = Thresholds(match=-100.0, landmark=-100.0)


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a detector and a CLIP model that learnt nothing, and eyes made of them."""
    folder = tmp_path_factory.mktemp("weights")
    config = DetectorConfig(CLASSES, width=96).with_choice(known_score=0.0, unknown_score=0.0)
    save_detector(build_network(config, seed=0), folder / "detector.safetensors", {})
    (folder / "clip").mkdir()
    torch.manual_seed(0)
    tower = open_clip.model.CLIP(**CLIP).state_dict()
    save_file({name: value.contiguous() for name, value in tower.items()}, folder / "clip/open_clip_model.safetensors")
    eyes = {"mean": [0.5] * 3, "std": [0.25] * 3}
    (folder / "clip/open_clip_config.json").write_text(json.dumps({"model_cfg": CLIP, "preprocess_cfg": eyes}))
    write_eyes(folder / "my.eyes.yaml", settings(folder), {"data": "none"})
    return folder


def settings(folder: Path, **changes: object) -> EyesSettings:
    files = {"detector": str(folder / "detector.safetensors"), "clip": str(folder / "clip"), "thresholds": ANYTHING}
    return EyesSettings(**{**files, **changes})


def frame() -> object:
    world = load_world(resolve_world("apartment"))
    camera = CameraSpec(CameraIntrinsics.from_fov(160, 120, 1.05), 0.0, 0.9, 0.1, 10.0, 15.0)
    return SimCamera(Scene.of(world), camera).capture(world.starts[0], 0.0, -0.3, 0.0)


def test_eyes_of_a_file_see(weights: Path) -> None:
    eyes = open_eyes(str(weights / "my.eyes.yaml"))
    assert eyes.classes == CLASSES
    known, unknown = split_landmarks(("tv monitor", "sofa", "desk"), eyes.classes)
    assert unknown == ("desk",)
    perceiver = Perceiver(eyes.detector, eyes.matcher, known=known, unknown=unknown, thresholds=eyes.thresholds)
    first, second = (perceiver.perceive(frame(), "tv or sofa") for _ in range(2))
    assert first.candidates
    assert [one.score for one in first.candidates] == [one.score for one in second.candidates]
    assert all(np.isfinite(one.position).all() for one in (*first.candidates, *first.sightings))


def test_weights_are_loaded_once_a_process(weights: Path) -> None:
    assert open_eyes("neural", settings(weights)) is open_eyes("neural", settings(weights))


def test_several_widths_find_at_least_as_much(weights: Path) -> None:
    one = open_eyes("neural", settings(weights)).detector.detect(frame())
    both = open_eyes("neural", settings(weights, widths=(96, 160))).detector.detect(frame())
    assert max(found.score for found in both) >= max(found.score for found in one)


def test_records_tell_the_weights(weights: Path) -> None:
    about = open_eyes("neural", settings(weights)).about
    assert about["sha256"] == {
        "detector": checksum(weights / "detector.safetensors"),
        "clip": checksum(weights / "clip"),
    }


def test_thresholds_of_other_weights_are_refused(weights: Path) -> None:
    with pytest.raises(
        InputError, match=r"^--perception: the thresholds were measured with another clip \(SHA-256 abc"
    ):
        open_eyes("neural", settings(weights, checksums=(("clip", "abc"),)))


def test_weights_of_something_else_are_refused(weights: Path) -> None:
    with pytest.raises(InputError, match=r"open_clip_model.safetensors: is no detector of this program \("):
        open_eyes("neural", settings(weights, detector=str(weights / "clip/open_clip_model.safetensors")))
    with pytest.raises(InputError, match=r"detector.safetensors"):
        open_eyes("neural", settings(weights, clip=str(weights / "detector.safetensors")))


def test_other_architecture_is_refused(weights: Path, tmp_path: Path) -> None:
    shutil.copytree(weights / "clip", tmp_path / "clip")
    config = tmp_path / "clip/open_clip_config.json"
    config.write_text(config.read_text().replace('"width": 8}', '"width": 16}'))
    with pytest.raises(InputError, match=r"another architecture"):
        open_eyes("neural", settings(weights, clip=str(tmp_path / "clip")))


def test_a_mission_with_neural_eyes_is_the_same_each_time(
    weights: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    threads = torch.get_num_threads()
    command = ["run", "search", "-t", "mug", "--world", "flat", "--robot", "locobot", "--max-seconds", "3", "--json"]
    results = []
    for name in ("first", "second"):
        result = CliRunner().invoke(app, [*command, "--perception", str(weights / "my.eyes.yaml"), "--record", name])
        assert result.exit_code in (0, 4), result.output
        results.append(json.loads(result.output.splitlines()[-1]) | {"wall_seconds": 0})
        eyes = json.loads(Path(name, "run.json").read_text())["settings"]["eyes"]
        assert eyes["sha256"]["clip"] == checksum(weights / "clip")
        assert eyes["thresholds"]["match"] == -100.0
    torch.set_num_threads(threads)
    assert results[0] == results[1]


def test_thresholds_that_come_along_belong_to_the_weights_that_come_along() -> None:
    file = WEIGHTS / "zavis-tiny.eyes.yaml"
    name, shipped = read_eyes(file)
    assert name == "neural"
    eyes = open_eyes(str(file))  # compares checksums
    assert eyes.thresholds == open_eyes("neural").thresholds == shipped.thresholds
    assert dict(shipped.checksums) == eyes.about["sha256"]


def test_networks_that_come_along_tell_furniture_and_bear_a_search() -> None:
    eyes = open_eyes("neural")
    assert eyes.classes is not None
    known, unknown = split_landmarks((*DEFAULT_KNOWN_LANDMARKS, *DEFAULT_UNKNOWN_LANDMARKS), eyes.classes)
    assert known == DEFAULT_KNOWN_LANDMARKS
    perceiver = Perceiver(eyes.detector, eyes.matcher, known=known, unknown=unknown, thresholds=eyes.thresholds)
    world = load_world(resolve_world("apartment"))
    camera = SimCamera(
        Scene.of(world), CameraSpec(CameraIntrinsics.from_fov(640, 480, 1.05), 0.0, 0.9, 0.1, 10.0, 15.0)
    )
    views = [camera.capture(world.starts[0], pan, -0.3, 0.0) for pan in np.arange(0.0, 6.3, 0.8)]
    found = [
        any(one.box.iou(thing.box) > 0.5 for one in eyes.detector.detect(view))
        for view in views
        for thing in view.instances
        if thing.visible_fraction > 0.6 and thing.box.area > 40**2
    ]
    assert np.mean(found) > 0.5
    assert sum(len(perceiver.perceive(view, "mug").sightings) for view in views) >= 1


def test_torch_is_loaded_for_neural_eyes_only() -> None:
    code = """
import sys
import zavis_bt.cli.main, zavis_bt.cli.simulate, zavis_bt.cli.bench, zavis_bt.cli.seeing
import zavis_bt.perception.neural, zavis_bt.perception.eyes_file, zavis_bt.perception.calibrating
from zavis_bt.cli.seeing import check_perception, eyes_of
import numpy
check_perception("neural")
eyes_of("simulated", ("sofa",), lambda name: numpy.random.default_rng(0), lambda a, b: 0.0)
loaded = {"torch", "torchvision", "open_clip", "transformers"} & set(sys.modules)
assert not loaded, loaded
"""
    subprocess.run([sys.executable, "-c", code], check=True)
