from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.bench import load_results
from zavis_bt.cli.main import app


@pytest.fixture
def episodes(tmp_path: Path) -> Path:
    """Two searches in the small flat, without shortest paths."""
    path = resolve_world("flat")
    world = load_world(path)
    objects = [
        {"id": o.id, "category": o.category, "x": o.x, "y": o.y, "z": o.z, "size": list(o.size), "on": o.on}
        for o in world.objects
    ]
    start = world.starts[0]
    lines = []
    for category in ("mug", "book"):
        instances = [o["id"] for o in objects if o["category"] == category]
        assert instances, f"the flat has no {category}"
        lines.append(
            json.dumps(
                {
                    "id": f"flat-{category}",
                    "group": "flat",
                    "world": str(path),
                    "start": [start.x, start.y, 0.0],
                    "target": {"category": category, "instances": instances},
                    "objects": objects,
                }
            )
        )
    file = tmp_path / "episodes.jsonl"
    file.write_text("\n".join(lines) + "\n")
    return file


def bench(*args: object) -> str:
    result = CliRunner().invoke(app, ["bench", *map(str, args)])
    assert result.exit_code == 0, result.output
    return result.output


def stable(path: Path) -> list[dict]:
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    for line in lines:
        assert line.pop("wall_seconds") > 0
    return lines


def test_results_do_not_depend_on_the_number_of_workers(episodes, tmp_path):
    for workers in (1, 2):
        bench(episodes, "-m", "zavis", "-m", "frontier", "-o", tmp_path / str(workers), "-j", workers)
    assert stable(tmp_path / "1" / "results.jsonl") == stable(tmp_path / "2" / "results.jsonl")


def test_every_method_meets_every_episode_and_spl_uses_a_computed_shortest_path(episodes, tmp_path):
    table = bench(episodes, "-m", "zavis", "-m", "nearest", "-o", tmp_path / "out")
    results = load_results(tmp_path / "out" / "results.jsonl")
    assert [(r.id, r.method) for r in results] == [
        (f"flat-{category}", method) for category in ("mug", "book") for method in ("zavis", "nearest")
    ]
    assert all(r.shortest_path_length is not None and r.spl is not None for r in results)
    assert all(r.details["collisions"] == 0 for r in results)
    assert "zavis" in table
    assert (tmp_path / "out" / "summary.md").exists()


def test_a_finished_benchmark_is_not_run_again(episodes, tmp_path):
    bench(episodes, "-m", "frontier", "-o", tmp_path / "out")
    before = (tmp_path / "out" / "results.jsonl").read_bytes()
    bench(episodes, "-m", "frontier", "-o", tmp_path / "out")
    assert (tmp_path / "out" / "results.jsonl").read_bytes() == before


def test_a_method_may_be_added_later_but_an_edited_tree_is_another_benchmark(episodes, tmp_path):
    tree = tmp_path / "mine" / "tree.yaml"
    tree.parent.mkdir()
    tree.write_text("bt: 1\nroot: t\ntrees:\n  t: {params: {target: str}, do: {fail: $target}}\n")
    bench(episodes, "-m", "frontier", "-o", tmp_path / "out")
    bench(episodes, "-m", "frontier", "-m", tree, "-o", tmp_path / "out")
    assert len(load_results(tmp_path / "out" / "results.jsonl")) == 4
    tree.write_text(tree.read_text() + "# edited\n")
    again = CliRunner().invoke(
        app, ["bench", str(episodes), "-m", "frontier", "-m", str(tree), "-o", str(tmp_path / "out")]
    )
    assert again.exit_code == 1
    assert "another folder" in again.output
