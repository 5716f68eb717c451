"""Episodes, results and work that the benchmark's tests share; importable in worker processes."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

from zavis_bt.bench import Episode, EpisodeObject, EpisodeResult, Task
from zavis_bt.types import MissionResult, Pose2D


def episode(name: str = "e1", group: str = "bedroom", shortest: float | None = 2.0) -> Episode:
    thing = EpisodeObject("mug_1", "mug", 1.0, 2.0, 0.5, (0.1, 0.1, 0.1), None)
    return Episode(name, group, Path("room.world.yaml"), Pose2D(0.0, 0.0), "mug", ("mug_1",), shortest, (thing,))


def result(**changes: Any) -> EpisodeResult:
    values: dict[str, Any] = {
        "id": "e1",
        "method": "zavis",
        "success": True,
        "reason": "found",
        "spl": 0.5,
        "path_length": 4.0,
        "shortest_path_length": 2.0,
        "waypoints": 3,
        "candidates": 2,
        "confirmations": 1,
        "sim_seconds": 61.5,
        "wall_seconds": 0.25,
        "seed": 0,
        "details": {"scans": 2},
        "group": "bedroom",
    }
    return EpisodeResult(**values | changes)


def mission(task: Task, **changes: Any) -> MissionResult:
    found = task.seed % 3 > 0
    path = 1.0 + task.seed % 7 / 3
    values: dict[str, Any] = {"spl": float(found) / path, "details": {"scans": 1}}
    return MissionResult(
        **{
            "id": "whatever",
            "method": "whatever",
            "success": found,
            "reason": "found" if found else "explored",
            "path_length": path,
            "shortest_path_length": 1.0,
            "waypoints": 2,
            "candidates": 1,
            "confirmations": 1,
            "sim_seconds": 10.0,
            "wall_seconds": 0.0,
            "seed": -1,
            **values,
            **changes,
        }
    )


def search(task: Task) -> MissionResult:
    """Work that ends well, later tasks sooner than earlier ones."""
    time.sleep(0.02 if task.episode.id.endswith(("0", "3")) else 0.0)
    return mission(task)


def search_noted(note: Path, task: Task) -> MissionResult:
    """Work that leaves a line for each time it was begun."""
    with note.open("a") as file:
        file.write(f"{task.episode.id} {task.method}\n")
    return search(task)


def search_once_fixed(fixed: Path, task: Task) -> MissionResult:
    """Work with a fault in episode e1 until a file says that it is mended."""
    if task.episode.id == "e1" and not fixed.exists():
        raise ZeroDivisionError("no\nway")
    return mission(task)


def search_fatally(task: Task) -> MissionResult:
    """Work that takes its process down in three ways."""
    match task.episode.id:
        case "e1":
            os.kill(os.getpid(), signal.SIGKILL)
        case "e2":
            sys.exit(7)
        case "e3":
            return mission(task, path_length=float("nan"))
    return mission(task)


def search_slowly(note: Path, task: Task) -> MissionResult:
    """Work that hangs from the third episode on, and leaves its process's id."""
    with note.open("a") as file:
        file.write(f"{os.getpid()}\n")
    if task.episode.id not in ("e0", "e1"):
        time.sleep(60)
    return mission(task)
