from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from bench_samples import result

from zavis_bt.bench import load_results
from zavis_bt.bench.results import from_line, to_line
from zavis_bt.errors import InputError
from zavis_bt.types import MissionResult


def test_a_line_gives_the_result_back() -> None:
    for original in (result(), result(spl=None, shortest_path_length=None, success=False, reason="Größe\n…")):
        assert from_line(to_line(original)) == original


def test_a_line_has_the_keys_of_a_mission_result_and_its_group() -> None:
    assert list(json.loads(to_line(result()))) == [*(field.name for field in fields(MissionResult)), "group"]


def test_numbers_are_rounded_also_inside_details() -> None:
    line = to_line(result(path_length=1 / 3, spl=-0.0, details={"seen": [np.float64(2 / 3)], "n": np.int64(2)}))
    content = json.loads(line)
    assert (content["path_length"], content["details"]) == (0.333333, {"seen": [0.666667], "n": 2})
    assert '"spl": 0.0' in line


@pytest.mark.parametrize("details", [{"a": float("inf")}, {"a": object()}])
def test_what_json_cannot_hold_is_an_error(details: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"not JSON compliant|cannot hold"):
        to_line(result(details=details))


def test_an_unfinished_last_line_is_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    path.write_text(to_line(result()) + "\n" + to_line(result(id="e2"))[:40])
    assert [kept.id for kept in load_results(tmp_path)] == ["e1"]


def test_a_foreign_line_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    path.write_text(to_line(result()) + '\n{"id": 1}\n')
    with pytest.raises(InputError, match=r"results.jsonl:2: is not a result: id .*valid string"):
        load_results(path)
    with pytest.raises(InputError, match="cannot be read"):
        load_results(tmp_path / "none")
