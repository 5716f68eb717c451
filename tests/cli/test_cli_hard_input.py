"""Unlucky input through the command line: nothing is wrong with it, and yet there is no way; the outcome is clear."""

from __future__ import annotations

import json
import re
import time
from pathlib import Path

import numpy as np
import pytest
from good_files import EPISODE, assert_refused, bench, other, run, states, write_map, zavis
from typer.testing import Result

from zavis_bt.bench import load_results
from zavis_bt.recording import load_run
from zavis_bt.types import OCCUPIED, UNKNOWN

pytestmark = pytest.mark.usefixtures("_good_files")


def world_of(name: str, cells: np.ndarray, *objects: str, start: str = "[1, 1, 0]") -> None:
    """Write ``<name>.world.yaml`` without furniture."""
    write_map(name, cells)
    things = "".join(f"  - {{{each}, size: [0.1, 0.1, 0.1]}}\n" for each in objects)
    Path(f"{name}.world.yaml").write_text(
        f"format: zavis-world/1\nname: {name}\nmap: {name}.yaml\n"
        + (f"objects:\n{things}" if things else "")
        + (f"starts:\n  - {start}\n" if start else "")
    )


def assert_not_found(result: Result, reason: str) -> None:
    """Exit code 4, the reason in one line for people, and everything in the run folder."""
    assert result.exit_code == 4, result.output
    assert re.search(f"not found: .*{reason}", result.output), result.output
    recorded = load_run(Path("run"))
    assert recorded.status == "ended"
    assert recorded.result is not None
    assert not recorded.result.success
    assert re.search(reason, recorded.result.reason)
    names = {file.name for file in Path("run").iterdir()}
    assert {"run.json", "map.yaml", "map.pgm", "map.png", "semantic_map.json", "events.jsonl"} <= names


def test_without_furniture_the_search_still_finds_what_lies_about_and_misses_what_does_not():
    world_of("bare", states(), "id: mug_1, category: mug, x: 3, y: 1, z: 0.5")
    assert run("search", world="bare").exit_code == 0
    result = zavis("run", "search", "-t", "wallet", "-w", "bare", "-r", "locobot", "--record", "run2")
    assert result.exit_code == 4
    assert "searched everything" in result.output


def test_what_lies_in_a_closed_room_is_not_found_and_the_search_ends_by_itself():
    cells = states()
    cells[:, 60:62] = OCCUPIED
    world_of("closed", cells, "id: mug_1, category: mug, x: 4, y: 3, z: 0.5")
    began = time.perf_counter()
    assert_not_found(run("search", world="closed"), "searched everything")
    assert time.perf_counter() - began < 20


def test_a_robot_that_is_walled_in_ends_by_itself():
    cells = states()
    cells[12:29, 28:30] = cells[12:29, 10:12] = cells[12:14, 10:30] = cells[27:29, 10:30] = OCCUPIED
    world_of("cell", cells, "id: mug_1, category: mug, x: 4, y: 3, z: 0.5")
    assert_not_found(run("search", world="cell"), "searched everything|nothing left")


@pytest.mark.usefixtures("_nothing_moves")
@pytest.mark.parametrize("state", [UNKNOWN, OCCUPIED])
def test_on_a_map_without_a_free_cell_nothing_begins(state):
    cells = np.full((80, 100), state, dtype=np.int8)
    world_of("none", cells)
    assert_refused(run(world="none"), r"none.world.yaml:5: start \(1, 1\) is in an obstacle \(a free cell is needed\)")
    world_of("none", cells, start="")
    assert_refused(run(world="none"), r"none: the world names no start \(give --start x,y,yaw\)")
    assert_refused(
        run("t.yaml", "--start", "1,1,0", world="none"), r"none.*: start \(1, 1\): the robot does not fit there"
    )


@pytest.mark.usefixtures("_nothing_moves")
@pytest.mark.parametrize("start", ["2.2,2.2,0", "2.2,1.9,0"], ids=["inside", "too near"])
def test_a_start_in_an_obstacle_is_refused(start):
    result = run("t.yaml", "--start", start)
    assert_refused(result, r"w.world.yaml: start \(2.2, .*\): the robot does not fit there \(obstacles are closer than")


@pytest.mark.usefixtures("_nothing_moves")
@pytest.mark.parametrize(
    ("target", "says"),
    [
        ("x" * 10_000, "target: 10000 characters .*at most 200"),
        (" ", "target: the text is empty"),
        ("a\x00b", "target: ha"),
    ],
    ids=["long", "blank", "control"],
)
def test_a_target_that_is_no_name_is_refused(target, says):
    assert_refused(run("search", target=target), says)


def test_a_benchmark_goes_on_after_an_episode_that_cannot_start():
    lines = [EPISODE, other(id="stuck", start=[2.2, 2.2, 0], shortest_path_length=2.0), other(id="e3")]
    Path("e.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    result = bench()
    assert result.exit_code == 0, result.output
    first, stuck, last = load_results(Path("out/results.jsonl"))
    assert (first.id, stuck.id, last.id) == ("e1", "stuck", "e3")
    assert first.success
    assert last.success
    assert (stuck.success, stuck.spl) == (False, 0.0)
    assert re.search(r"start \(2.2, 2.2\): the robot does not fit there", stuck.reason)
    assert "1 of 3 runs CRASHED and count as failures" in result.output
