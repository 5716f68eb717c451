"""A folder with a small world, a robot, a tree and an episode, all good, and the commands that use them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from typer.testing import CliRunner, Result

from drivers.profiles import builtin_robot
from zavis_bt.cli.main import app
from zavis_bt.mapping import save_map
from zavis_bt.types import FREE, OCCUPIED, GridMap

WORLD = """\
format: zavis-world/1
name: home
map: home.yaml
furniture:
  - {id: desk_1, category: desk, x: 2.25, y: 2.25, size: [0.5, 0.5], height: 0.75}
objects:
  - {id: mug_1, category: mug, x: 2.2, y: 2.2, z: 0.75, size: [0.1, 0.1, 0.1], on: desk_1}
starts:
  - [1, 1, 0]
"""
ROBOT = builtin_robot("locobot").read_text(encoding="utf-8")
TREE = """\
bt: 1
root: m
trees:
  m:
    params: {target: str}
    do:
      sequence:
        - scan: {target: $target, save: seen}
"""
MUG: dict[str, Any] = {"id": "mug_1", "category": "mug", "x": 2.2, "y": 2.2, "z": 0.75, "size": [0.1, 0.1, 0.1]}
EPISODE: dict[str, Any] = {
    **{"id": "e1", "group": "home", "world": "w.world.yaml", "start": [1, 1, 0]},
    **{"target": {"category": "mug", "instances": ["mug_1"]}, "objects": [MUG]},
}


def other(**changes: object) -> dict[str, object]:
    """Return another episode."""
    return {**EPISODE, "id": "e2", **changes}


def states(columns: int = 100) -> np.ndarray:
    """4 m of room with walls."""
    room = np.full((80, columns), FREE, dtype=np.int8)
    room[:2], room[-2:], room[:, :2], room[:, -2:] = (OCCUPIED,) * 4
    return room


def write_map(name: str, cells: np.ndarray) -> None:
    save_map(Path(f"{name}.yaml"), GridMap(cells, 0.05, (0.0, 0.0)))


def write_good_files() -> None:
    """Write them all into the folder we are in."""
    room = states()
    room[40:50, 40:50] = OCCUPIED
    write_map("home", room)
    Path("w.world.yaml").write_text(WORLD)
    Path("r.robot.yaml").write_text(ROBOT)
    Path("t.yaml").write_text(TREE.replace(", save: seen", ""))
    Path("e.jsonl").write_text(json.dumps(EPISODE) + "\n")


def zavis(*args: object) -> Result:
    return CliRunner().invoke(app, [str(arg) for arg in args])


def run(tree: str = "t.yaml", *more: object, target: str = "mug", world: str = "w.world.yaml") -> Result:
    where = ("--world", world, "--robot", "r.robot.yaml", "--record", "run")
    return zavis("run", tree, "--target", target, *where, *more)


def bench(*more: object) -> Result:
    return zavis("bench", "e.jsonl", "--method", "zavis", "--out", "out", *more)


def assert_refused(result: Result, says: str) -> None:
    assert result.exit_code == 1, result.output
    (line,) = result.output.strip().splitlines()
    assert re.match(says, line), line
    assert "Traceback" not in line
    assert not Path("run").exists()
    assert not Path("out").exists()
