from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from zavis_bt.cli.main import app
from zavis_bt.errors import InputError
from zavis_bt.perception import EyesSettings, neural

EPISODE = {
    **{"id": "e1", "group": "home", "world": "apartment.world.yaml", "start": [1, 1, 0]},
    **{"target": {"category": "mug", "instances": ["mug_1"]}, "shortest_path_length": 1.0},
    "objects": [{"id": "mug_1", "category": "mug", "x": 2, "y": 2, "z": 0.7, "size": [0.1, 0.1, 0.1]}],
}


@pytest.fixture(autouse=True)
def _home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from sim.worlds import builtin_world

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    world = builtin_world("apartment")
    for file in world.parent.glob("apartment.*"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    Path("e.jsonl").write_text(json.dumps(EPISODE) + "\n")


def zavis(*args: object) -> Result:
    return CliRunner().invoke(app, [str(arg) for arg in args])


def assert_refused(result: Result, says: str) -> None:
    assert result.exit_code == 1, result.output
    (line,) = result.output.strip().splitlines()
    assert says in line
    assert not Path("runs").exists()
    assert not Path("out").exists()


def eyes_file(**entries: object) -> str:
    Path("my.eyes.yaml").write_text(json.dumps({"format": "zavis-eyes/1", **entries}))
    return "my.eyes.yaml"


@pytest.mark.parametrize(
    ("perception", "says"),
    [
        ("neurl", "--perception: 'neurl' is unknown (did you mean 'neural'?)"),
        ("simulatd", "--perception: 'simulatd' is unknown (did you mean 'simulated'?)"),
        ("none.eyes.yaml", "none.eyes.yaml: cannot be read: No such file or directory"),
    ],
)
@pytest.mark.parametrize(
    "command",
    [
        ("run", "search", "--target", "mug"),
        ("bench", "e.jsonl", "--method", "zavis", "--out", "out"),
        ("demo", "--no-view"),
    ],
)
def test_eyes_that_there_are_not_are_refused(command: tuple[str, ...], perception: str, says: str) -> None:
    assert_refused(zavis(*command, "--perception", perception), says)


def test_faulty_eyes_file_is_refused_before_anything_moves() -> None:
    file = eyes_file(thresholds={"match": 29, "landmark": 24, "temperature": -1})
    assert_refused(zavis("run", "search", "--target", "mug", "--perception", file), "thresholds.temperature: should be")


@pytest.mark.parametrize(
    ("entries", "says"),
    [
        ({"detector": "nowhere/my.pt"}, "nowhere/my.pt: no such file"),
        ({"detector": "no-such-weights"}, "no-such-weights"),
        ({"device": "tpu"}, "my.eyes.yaml: device: 'tpu' is unknown (cpu or cuda)"),
        ({"clip": "ViT-L-14@nowhere.pt"}, "no thresholds are known for 'ViT-L-14@nowhere.pt' (measure them: zavis per"),
    ],
)
def test_weights_that_cannot_be_had_are_told_before_the_first_episode(entries: dict[str, object], says: str) -> None:
    pytest.importorskip("open_clip")
    Path("any.pt").write_bytes(b"weights")
    file = eyes_file(**{"detector": "any.pt", **entries})
    assert_refused(zavis("bench", "e.jsonl", "--method", "zavis", "--out", "out", "--perception", file), says)


def test_thresholds_of_other_weights_are_refused() -> None:
    settings = EyesSettings(checksums=(("detector", "ab" * 32),), where="my.eyes.yaml")
    says = r"my.eyes.yaml: the thresholds were measured with another detector \(SHA-256 abababababab…, this one has cdc"
    with pytest.raises(InputError, match=says):
        neural.check_checksums(settings, {"detector": "cd" * 32})
    neural.check_checksums(settings, {"detector": "ab" * 32, "clip": "ef" * 32})


@pytest.mark.parametrize(
    ("args", "says"),
    [
        (("calibrate", "nowhere", "--out", "my.eyes.yaml"), "nowhere: there is no such data set"),
        (("calibrate", ".", "--out", "none/my.eyes.yaml"), "--out: there is no folder none (make it first)"),
        (("calibrate", ".", "--out", "x.eyes.yaml"), "is no data set"),
        (("show", "simulated"), "simulated: has no weights to show"),
        (("show", "sim"), "--perception: 'sim' is unknown"),
    ],
)
def test_wrong_arguments_are_told(args: tuple[str, ...], says: str) -> None:
    assert_refused(zavis("perception", *args), says)
