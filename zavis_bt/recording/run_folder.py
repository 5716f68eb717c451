"""The folder of a run: where its files are, and reading them back."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.mapping import load_map
from zavis_bt.mapping.semantic_file import decode_landmarks
from zavis_bt.types import Event, FloatArray, GridMap, Landmark, MissionResult

FORMAT = "zavis-run/1"
RUNNING, ENDED = "running", "ended"


@dataclass(frozen=True, slots=True)
class RunFolder:
    """Names of the files in a run folder."""

    path: Path

    @property
    def run(self) -> Path:
        """Result, settings, seed and versions; there from the first moment on."""
        return self.path / "run.json"

    @property
    def events(self) -> Path:
        """The journal, one event a line, written as it happens."""
        return self.path / "events.jsonl"

    @property
    def map(self) -> Path:
        """The occupancy map; its image is ``map.pgm``."""
        return self.path / "map.yaml"

    @property
    def semantic_map(self) -> Path:
        """The landmarks."""
        return self.path / "semantic_map.json"

    @property
    def trajectory(self) -> Path:
        """Where the robot was and when."""
        return self.path / "trajectory.csv"

    @property
    def tree(self) -> Path:
        """The tree as it stood at the end."""
        return self.path / "tree.txt"

    @property
    def picture(self) -> Path:
        """The map with everything on it."""
        return self.path / "map.png"

    @property
    def candidates(self) -> Path:
        """Folder with a picture of each candidate and ``index.json``."""
        return self.path / "candidates"


@dataclass(frozen=True, slots=True)
class Run:
    """A recorded run. What a run that was broken off did not come to write is None or empty."""

    folder: RunFolder
    status: str
    """``running`` (or broken off) or ``ended``."""
    result: MissionResult | None
    settings: Mapping[str, Any]
    versions: Mapping[str, str]
    problems: tuple[str, ...]
    """What could not be recorded."""
    events: tuple[Event, ...]
    grid: GridMap | None
    landmarks: tuple[Landmark, ...]
    trajectory: FloatArray
    """(n, 4): stamp [s], x [m], y [m], yaw [rad]."""
    candidates: tuple[Mapping[str, Any], ...]
    """Entries of ``candidates/index.json``: file, score, position, accepted, …."""
    tree: str


def new_run_folder(parent: Path | str, stamp: datetime) -> Path:
    """Return a name for a run that began at a time, e.g. ``runs/2025-03-08_14-05-09``; nothing is created.

    A name that is taken gets a number, ``…-2``.
    """
    base = Path(parent) / stamp.strftime("%Y-%m-%d_%H-%M-%S")
    path, number = base, 2
    while path.exists():
        path, number = base.with_name(f"{base.name}-{number}"), number + 1
    return path


def load_run(folder: Path | str) -> Run:
    """Read a run folder; one of a run that was killed is read as far as it was written.

    Raises:
        InputError: The folder holds no run, or a file in it is damaged.
    """
    files = RunFolder(Path(folder))
    if not files.run.is_file():
        raise InputError(f"{folder}: holds no run (a folder with a run.json would be right)")
    content = _read_json(files.run)
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(f"{files.run}: not a run (format {FORMAT!r} would be right)")
    index = files.candidates / "index.json"
    return Run(
        folder=files,
        status=content.get("status", ENDED),
        result=_result(files.run, content) if "success" in content else None,
        settings=content.get("settings", {}),
        versions=content.get("versions", {}),
        problems=tuple(content.get("problems", ())),
        events=tuple(_events(files.events)),
        grid=load_map(files.map) if files.map.is_file() else None,
        landmarks=_landmarks(files.semantic_map),
        trajectory=_trajectory(files.trajectory),
        candidates=tuple(_read_json(index)) if index.is_file() else (),
        tree=_read(files.tree) if files.tree.is_file() else "",
    )


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not text: {error}") from error


def _landmarks(path: Path) -> tuple[Landmark, ...]:
    return decode_landmarks(_read(path), str(path)) if path.is_file() else ()


def _read_json(path: Path) -> Any:
    try:
        return json.loads(_read(path))
    except ValueError as error:
        raise InputError(f"{path}: not JSON: {error}") from error


def _result(path: Path, content: Mapping[str, Any]) -> MissionResult:
    names = [field.name for field in dataclasses.fields(MissionResult)]
    try:
        return MissionResult(**{name: content[name] for name in names})
    except KeyError as error:
        raise InputError(f"{path}: {error.args[0]} is missing (a result has {', '.join(names)})") from error


def _events(path: Path) -> Iterator[Event]:
    if not path.is_file():
        return
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    for number, line in enumerate(lines, start=1):
        try:
            entry = json.loads(line)
            yield Event(entry["stamp"], entry["kind"], entry["data"])
        except (ValueError, KeyError, TypeError) as error:
            if number == len(lines):
                return  # the program was killed in the middle of its last line
            raise InputError(f"{path}:{number}: not an event: {error}") from error


def _trajectory(path: Path) -> FloatArray:
    if not path.is_file():
        return np.empty((0, 4))
    try:
        rows = [[float(cell) for cell in line.split(",")] for line in _read(path).splitlines()[1:]]
        return np.array(rows, dtype=np.float64).reshape(-1, 4)
    except ValueError as error:
        raise InputError(f"{path}: not a trajectory: {error}") from error
