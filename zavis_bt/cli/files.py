"""Finding the files that a user names: trees, robots, starts, inputs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.types import GridMap, Pose2D, RobotSpec

if TYPE_CHECKING:
    from zavis_bt.mapping import SemanticMap
    from zavis_bt.mission.robot_file import RobotFile


def resolve_tree(name: str) -> Path:
    """Return the tree file of that path or of that built-in name.

    Raises:
        InputError: There is neither.
    """
    folder = Path(str(files("trees")))
    return _resolve(name, "tree", {path.stem: path for path in sorted(folder.glob("*.yaml"))})


def load_robot_file(name: str) -> RobotFile:
    """Return the robot of that file or profile.

    Raises:
        InputError: There is neither, or the file is wrong.
    """
    from drivers.profiles import builtin_robot, builtin_robots
    from zavis_bt.mission.robot_file import load_robot

    return load_robot(_resolve(name, "robot", {robot: builtin_robot(robot) for robot in builtin_robots()}))


def load_robot_spec(name: str) -> RobotSpec:
    """Return the model of the robot of that file or profile.

    Raises:
        InputError: There is neither, or the file is wrong.
    """
    return load_robot_file(name).spec


def _resolve(name: str, what: str, built_in: Mapping[str, Path]) -> Path:
    if name in built_in:
        return built_in[name]
    if Path(name).is_file():
        return Path(name)
    raise InputError(f"{name}: no such file, and no built-in {what} of that name{did_you_mean(name, built_in)}")


def load_maps(path: Path) -> tuple[GridMap, SemanticMap | None]:
    """Return the maps of a run folder or beside a ``map.yaml``: the grid, and the landmarks if they were saved.

    Raises:
        InputError: There is no map, or it is damaged.
    """
    from zavis_bt.mapping import SemanticMap, load_map

    file = path / "map.yaml" if path.is_dir() else path
    semantic = file.parent / "semantic_map.json"
    return load_map(file), SemanticMap.load(semantic) if semantic.is_file() else None


def parse_start(text: str) -> Pose2D:
    """Return the pose written as ``x,y,yaw`` in metres and degrees.

    Raises:
        InputError: It is written otherwise.
    """
    try:
        x, y, yaw_deg = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--start: '{text}' is not a pose (x,y,yaw in metres and degrees, e.g. 1.5,2,90)") from None
    if not all(math.isfinite(value) for value in (x, y, yaw_deg)):
        raise InputError(f"--start: '{text}' is not finite (x,y,yaw in metres and degrees)")
    return Pose2D(x, y, math.radians(yaw_deg))


def tree_inputs(path: Path, assignments: Sequence[str]) -> tuple[tuple[str, Any], ...]:
    """Return the inputs of a tree written as ``name=value``, converted to the types the tree declares.

    Raises:
        InputError: An assignment is not of that form, or the tree has no such input.
    """
    from zavis_bt.tree import Registry, parse_input, read_inputs

    declared = {item.name: item for item in read_inputs(path, Registry.from_entry_points())}
    pairs = []
    for name, text in _split(assignments):
        if name not in declared:
            raise InputError(f"{path}: the tree has no input '{name}'{did_you_mean(name, declared)}")
        pairs.append((name, parse_input(declared[name], text)))
    return tuple(pairs)


def _split(assignments: Iterable[str]) -> list[tuple[str, str]]:
    pairs = []
    for assignment in assignments:
        name, sign, text = assignment.partition("=")
        if not sign or not name.strip():
            raise InputError(f"--set: '{assignment}' is no assignment (name=value, e.g. order=nearest)")
        pairs.append((name.strip(), text.strip()))
    return pairs
