"""``zavis tree``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tree_kinds import REGISTRY, SAFETY, SEARCH, write
from typer.testing import CliRunner, Result

import zavis_bt.tree
from zavis_bt.cli.tree import app
from zavis_bt.errors import InputError
from zavis_bt.tree import Registry


@pytest.fixture(autouse=True)
def _registry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Registry, "from_entry_points", classmethod(lambda cls: REGISTRY))
    monkeypatch.setenv("COLUMNS", "200")


@pytest.fixture
def search(tmp_path: Path) -> Path:
    write(tmp_path, SAFETY, "safety.yaml")
    return write(tmp_path, SEARCH, "search.yaml")


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_check_says_ok_for_each_file(search: Path) -> None:
    result = run("check", search)
    assert (result.exit_code, result.stdout) == (0, f"{search}: ok\n")


def test_check_prints_all_faults_of_all_files(search: Path, tmp_path: Path) -> None:
    bad = write(tmp_path, SEARCH.replace("turns: 1", "turn: 1"), "bad.yaml")
    result = run("check", bad, search)
    assert result.exit_code == 1
    assert result.stderr.count("error[argument]") == 2
    assert result.stdout == f"{search}: ok\n"


def test_show_draws_the_tree_with_ids(search: Path) -> None:
    lines = run("show", search).stdout.splitlines()
    assert lines[0].split() == ["search", "search"]
    line = next(line for line in lines if "initial scan" in line)
    assert line.startswith("         │  └─ initial scan (scan)") or "─ initial scan (scan)" in line
    assert line.endswith("  mission/sequence.0/scan")


def test_show_writes_dot_and_html(search: Path) -> None:
    assert run("show", search, "--dot").stdout.startswith("digraph")
    assert "<title>search.yaml</title>" in run("show", search, "--html").stdout


def test_fmt_changes_a_file_once(tmp_path: Path) -> None:
    path = write(tmp_path, "bt:  1\nroot: m\ntrees: {m: {do: scan}}\n")
    assert run("fmt", "--check", path).exit_code == 1
    assert run("fmt", path).stdout == f"{path}: formatted\n"
    assert run("fmt", "--check", path).exit_code == 0
    assert path.read_text().startswith("bt: 1\n")


def test_fmt_of_a_missing_file_is_a_user_error(tmp_path: Path) -> None:
    assert isinstance(run("fmt", tmp_path / "none.yaml").exception, InputError)


def test_schema_knows_the_trees_of_given_files(search: Path) -> None:
    plain = json.loads(run("schema").stdout)["$defs"]["mapping"]["properties"]
    with_trees = json.loads(run("schema", search).stdout)["$defs"]["mapping"]["properties"]
    assert {"mission", "visit", "search", "safety.dock", "safety.estop_clear"} == set(with_trees) - set(plain)


def test_kinds_lists_all_and_describes_one() -> None:
    table = run("kinds").stdout
    assert all(kind in table for kind in ("navigate", "sequence", "for_each", "wait", "set"))
    page = run("kinds", "navigate").stdout
    assert all(word in page for word in ("tolerance", "≥ 0.05, ≤ 2", "path_length", "Pose2D | Viewpoint", "required"))


def test_an_unknown_kind_is_a_user_error() -> None:
    result = run("kinds", "navgate")
    assert isinstance(result.exception, InputError)
    assert "did you mean 'navigate'" in str(result.exception)


def test_the_public_names_exist() -> None:
    assert all(hasattr(zavis_bt.tree, name) for name in zavis_bt.tree.__all__)
