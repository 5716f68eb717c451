from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from zavis_bt.cli.main import app
from zavis_bt.recording import load_run


def zavis(*args: object) -> Result:
    return CliRunner().invoke(app, [str(arg) for arg in args])


def run_flat(tmp_path: Path, *args: object) -> Result:
    return zavis("run", "search", "--world", "flat", "--robot", "locobot", "--record", tmp_path / "run", *args)


def test_a_mission_finds_its_target_and_leaves_a_complete_run_folder(tmp_path):
    result = run_flat(tmp_path, "--target", "mug", "--json")
    assert result.exit_code == 0, result.output
    line = json.loads(result.stdout)
    assert line["success"]
    assert line["details"]["collisions"] == 0
    run = load_run(tmp_path / "run")
    assert run.status == "ended"
    assert run.result is not None
    assert run.result.path_length == pytest.approx(line["path_length"])
    names = {file.name for file in (tmp_path / "run").iterdir()}
    assert {"run.json", "map.yaml", "map.pgm", "map.png", "semantic_map.json", "events.jsonl", "candidates"} <= names


def test_the_same_seed_gives_the_same_run(tmp_path):
    lines = []
    for name in ("a", "b"):
        line = json.loads(run_flat(tmp_path / name, "--target", "mug", "--seed", 3, "--json").stdout)
        del line["wall_seconds"]
        lines.append(line)
    assert lines[0] == lines[1]


def test_what_is_not_there_is_not_found_and_the_exit_code_says_so(tmp_path):
    result = run_flat(tmp_path, "--target", "harpsichord", "--max-travel", 8)
    assert result.exit_code == 4
    assert "not found" in result.output
    assert load_run(tmp_path / "run").result.success is False


@pytest.mark.parametrize(
    ("args", "says"),
    [
        (("--target", ""), "target: the text is empty"),
        (("--target", "x" * 10_000), "target: 10000 characters"),
        (("--target", "a\nb"), "one line of plain text"),
        (("--target", "mug", "--prior", "comonsense"), "did you mean 'commonsense'?"),
        (("--target", "mug", "--order", "greedi"), "greedy"),
        (("--target", "mug", "--planner", "a-star"), "astar"),
        (("--target", "mug", "--confirm", "oracel"), "did you mean 'oracle'?"),
        (("--target", "mug", "--perception", "neurol"), "--perception"),
        (("--target", "mug", "--set", "speed"), "name=value"),
        (("--target", "mug", "--set", "lamda_1=2"), "did you mean 'lambda_1'?"),
        (("--target", "mug", "--set", "lambda_1=fast"), "lambda_1"),
        (("--target", "mug", "--start", "1,2"), "x,y,yaw"),
        (("--target", "mug", "--start", "500,2,0"), "outside the map"),
        (("--target", "mug", "--known", "sofa,sofa"), "given twice"),
        (("--target", "mug", "--world", "flot"), "did you mean 'flat'?"),
        (("--target", "mug", "--robot", "lokobot"), "did you mean 'locobot'?"),
    ],
)
def test_a_wrong_argument_is_one_line_and_nothing_is_recorded(tmp_path, args, says):
    result = run_flat(tmp_path, *args)
    assert result.exit_code == 1, result.output
    assert says in result.output
    assert len(result.output.strip().splitlines()) == 1
    assert not (tmp_path / "run").exists()


def test_a_run_folder_is_never_overwritten(tmp_path):
    run_flat(tmp_path, "--target", "mug")
    again = run_flat(tmp_path, "--target", "mug")
    assert again.exit_code == 1
    assert "holds a run already" in again.output


def test_ctrl_c_leaves_a_complete_run_folder(tmp_path):
    command = [sys.executable, "-m", "zavis_bt", "run", "search", "-t", "harpsichord", "-w", "apartment", "--real-time"]
    process = subprocess.Popen([*command, "--record", str(tmp_path / "run")], stderr=subprocess.PIPE, text=True)
    events = tmp_path / "run" / "events.jsonl"
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not (events.exists() and (tmp_path / "run" / "run.json").exists()):
        time.sleep(0.1)
    time.sleep(3.0)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=20)
    assert process.returncode == 130, stderr
    assert "Traceback" not in stderr
    run = load_run(tmp_path / "run")
    assert run.status == "ended"
    assert run.result.reason == "interrupted"
    assert (tmp_path / "run" / "map.png").exists()


def test_help_is_quick_to_import_because_heavy_libraries_wait():
    code = "import sys; from zavis_bt.cli.main import app; print(*sorted(sys.modules))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert not {"numba", "cv2", "ompl", "meshcat", "wordllama", "torch", "py_trees"} & set(loaded)


def test_version_and_help_exit_with_0():
    assert zavis("--version").output.startswith("zavis_bt ")
    assert zavis("--help").exit_code == 0
    assert zavis("no-such-command").exit_code == 2


def test_a_bug_shows_its_traceback_and_exits_with_3(monkeypatch):
    def broken(name: str) -> Path:
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr("zavis_bt.cli.files.resolve_tree", broken)
    result = zavis("run", "search", "-t", "mug")
    assert result.exit_code == 3
    assert "ZeroDivisionError: a bug" in result.output
    assert os.linesep in result.output
