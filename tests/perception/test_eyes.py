from __future__ import annotations

import math
from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest
from perception_scene import ScriptedDetector, ScriptedMatcher, frame_of, unknown

from zavis_bt.errors import InputError
from zavis_bt.perception import Eyes, EyesSettings, Thresholds, eyes, neural, open_eyes, split_landmarks
from zavis_bt.perception.contrast import Contrast, ContrastMatcher
from zavis_bt.perception.eyes_file import read_eyes, write_eyes
from zavis_bt.perception.several_scales import SeveralScales
from zavis_bt.types import Box, Detection

BOX = Box(1, 1, 9, 9)
GOOD = """\
format: zavis-eyes/1
detector: zavis-tiny-detector
clip: zavis-tiny
thresholds: {match: 61.5, landmark: 40.25, temperature: 4.5}
calibrated:
  data: val
  weights: {clip: abc}
"""


def scripted(settings: EyesSettings) -> Eyes:
    """Eyes that are not ours; the entry point of the tests."""
    return Eyes(ScriptedDetector(), ScriptedMatcher(), settings.thresholds or Thresholds(), about={"s": settings})


@pytest.fixture
def _plug_in(monkeypatch: pytest.MonkeyPatch) -> None:
    point = EntryPoint("scripted", f"{__name__}:scripted", eyes.ENTRY_POINT_GROUP)
    monkeypatch.setattr(eyes, "entry_points", lambda group: (point,))


@pytest.mark.usefixtures("_plug_in")
def test_plug_in_is_found_by_its_name() -> None:
    opened = open_eyes("scripted", EyesSettings(device="cuda"))
    assert opened.about["s"].device == "cuda"
    assert opened.thresholds == Thresholds()


@pytest.mark.usefixtures("_plug_in")
def test_file_names_eyes_weights_and_options(tmp_path: Path) -> None:
    (tmp_path / "mine.pt").touch()
    file = tmp_path / "my.eyes.yaml"
    file.write_text(
        "format: zavis-eyes/1\nperception: scripted\ndetector: mine.pt\nclip: ViT-B-32@mine.pt\noptions: {a: 1}\n"
        "thresholds: {match: 30, landmark: 20, temperature: 2, detection: 0.3}\n"
    )
    settings = open_eyes(str(file), EyesSettings(threads=1)).about["s"]
    assert settings.detector == str(tmp_path / "mine.pt")
    assert settings.clip == f"ViT-B-32@{tmp_path / 'mine.pt'}"
    assert settings.options == {"a": 1}
    assert settings.thresholds == Thresholds(30, 20, 2, 0.3)
    assert settings.threads == 1
    assert settings.where == str(file)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("neurl", r"--perception: 'neurl' is unknown \(did you mean 'neural'\?\)"),
        ("no.eyes.yaml", "no.eyes.yaml: cannot be read: No such file"),
    ],
)
def test_eyes_that_there_are_not_are_refused(name: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        open_eyes(name)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("eyes/1", "eyes/2", r":1: format: should be 'zavis-eyes/1'"),
        ("clip: zavis", "clop: zavis", r":3: unknown key 'clop' \(did you mean 'clip'\?\)"),
        ("61.5", "high", r":4: thresholds.match: should be a"),
        ("temperature: 4.5", "temperature: 0", r":4: thresholds.temperature: should be greater than 0"),
        (", landmark: 40.25", "", r":4: key 'thresholds.landmark' is missing"),
        ("clip: abc", "eye: abc", r":7: "),
    ],
)
def test_faults_of_a_file_are_told_with_their_line(tmp_path: Path, old: str, new: str, says: str) -> None:
    file = tmp_path / "my.eyes.yaml"
    file.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(InputError, match=says):
        read_eyes(file)


def test_file_of_a_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "my.eyes.yaml"
    file.write_text("format: zavis-eyes/1\nperception: other.yaml\n")
    with pytest.raises(InputError, match=r":2: perception: should be a name"):
        read_eyes(file)


def test_what_is_written_is_read_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "weights").mkdir()
    (tmp_path / "out").mkdir()
    (tmp_path / "weights" / "mine.pt").touch()
    monkeypatch.chdir(tmp_path)
    settings = EyesSettings(
        "weights/mine.pt", "ViT-B-32@openai", "cuda", (320, 640), None, Thresholds(30, 20, 2.5, 0.1)
    )
    settings = replace(
        settings, checksums=(("clip", "abc"), ("detector", "def")), contrast=Contrast(("mug", "no"), 3.5)
    )
    write_eyes(Path("out/my.eyes.yaml"), settings, {"data": "val"})
    monkeypatch.chdir("/")
    name, read = read_eyes(tmp_path / "out" / "my.eyes.yaml")
    assert name == "neural"
    assert Path(read.detector or "").resolve() == tmp_path / "weights" / "mine.pt"
    assert replace(read, detector=None, where="") == replace(settings, detector=None, where="")


def test_file_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_eyes(tmp_path / "nowhere" / "my.eyes.yaml", EyesSettings(), {})


def test_neural_eyes_without_torch_say_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(neural, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"^--perception: neural: needs torch \(pip install 'zavis_bt\[neural\]'\)$"):
        open_eyes("neural")


def test_thresholds_are_known_for_the_papers_model_only() -> None:
    for clip in ("ViT-B-32@openai", "vit-b-32-laion2b"):
        settings = neural.with_meaning(EyesSettings(clip=clip))
        assert settings.thresholds == Thresholds(29.0, 24.0, 1.0)
        assert settings.contrast is None
    with pytest.raises(InputError, match=r"no thresholds are known for 'ViT-L-14@openai' \(measure them: zavis perc"):
        neural.with_meaning(EyesSettings(clip="ViT-L-14@openai"))


def test_detectors_classes_decide_which_landmarks_are_known() -> None:
    names = ("tv monitor", "sofa", "dining table", "desk", "bed", "couch")
    known, unknown = split_landmarks(names, ("chair", "tv", "couch", "diningtable"))
    assert known == ("tv monitor", "sofa", "dining table")
    assert unknown == ("desk", "bed")


def test_relative_score_is_the_softmaxs_logarithm() -> None:
    scores = {BOX: {"mug": 30.0, "desk": 26.0, "bed": 20.0}}
    matcher = ContrastMatcher(ScriptedMatcher(scores), Contrast(("mug", "desk", "bed"), 2.0))
    (row,) = matcher.match(frame_of([]), [BOX], ["mug", "bed"])
    odds = np.exp(np.array([30.0, 26.0, 20.0]) / 2)
    assert row == pytest.approx(2 * np.log(odds[[0, 2]] / odds.sum()))
    assert matcher.match(frame_of([]), [], ["mug"]).shape == (0, 1)


@pytest.mark.parametrize(("texts", "temperature"), [((), 1.0), (("mug",), 0.0), (("mug",), math.inf)])
def test_contrast_out_of_range_is_refused(texts: tuple[str, ...], temperature: float) -> None:
    with pytest.raises(InputError, match=r"^contrast: "):
        Contrast(texts, temperature)


def test_several_scales_keep_the_best_box_of_each_thing() -> None:
    other = Box(20, 20, 40, 40)
    small = ScriptedDetector(unknown(Box(1, 1, 9, 8.5), 0.9))
    large = ScriptedDetector(unknown(BOX, 0.8), unknown(other, 0.95), Detection(BOX, "sofa", 0.3))
    found = SeveralScales({32: small, 64: large}).detect(frame_of([]))
    assert [(one.box, one.score) for one in found] == [(other, 0.95), (Box(1, 1, 9, 8.5), 0.9), (BOX, 0.3)]


def test_a_scale_that_would_show_the_same_image_again_is_left_out() -> None:
    width = frame_of([]).intrinsics.width
    below, at, above = (ScriptedDetector(unknown(BOX, score)) for score in (0.3, 0.5, 0.9))
    (best,) = SeveralScales({width // 2: below, width: at, 2 * width: above}).detect(frame_of([]))
    assert best.score == 0.5
