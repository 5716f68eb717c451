"""Many missions in parallel, resumable, with results that do not depend on the number of workers."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from zavis_bt.bench.episodes import Episode
from zavis_bt.bench.folder import BenchFolder, Key
from zavis_bt.bench.pool import Crash, run_in_processes
from zavis_bt.bench.results import CRASH, EpisodeResult, from_line, to_line
from zavis_bt.types import MissionResult


@dataclass(frozen=True, slots=True)
class Task:
    """One episode to be searched by one method."""

    episode: Episode
    method: str
    seed: int

    @property
    def key(self) -> Key:
        """What tells tasks apart: episode, method and seed."""
        return self.episode.id, self.method, self.seed


def make_tasks(episodes: Sequence[Episode], methods: Sequence[str], seed: int = 0, repeats: int = 1) -> list[Task]:
    """Return a task for every episode, repeat and method, the methods innermost.

    Each episode and repeat has a seed of its own, drawn from ``seed`` and the episode's id: methods meet the same
    chances, and an episode's seed does not depend on which others are run.

    Args:
        episodes: What to search.
        methods: Names of the methods.
        seed: Of the whole benchmark, not negative.
        repeats: How often each method searches each episode.
    """
    return [
        Task(episode, method, _episode_seed(seed, episode.id, repeat))
        for episode in episodes
        for repeat in range(repeats)
        for method in dict.fromkeys(methods)
    ]


def _episode_seed(seed: int, episode: str, repeat: int) -> int:
    return int(np.random.SeedSequence((seed, zlib.crc32(episode.encode()), repeat)).generate_state(1)[0])


def run_benchmark(
    tasks: Sequence[Task],
    run_one: Callable[[Task], MissionResult],
    out: Path | str,
    *,
    settings: Mapping[str, Any],
    workers: int = 1,
    progress: bool = True,
) -> list[EpisodeResult]:
    """Run the tasks that the folder has no result of yet.

    A task that raises, or whose process dies, becomes a failed result with a reason that begins with ``crash:``; it is
    run again when the benchmark is resumed. The result's id, method and seed are those of the task.

    Args:
        tasks: What to run, no two with the same episode, method and seed.
        run_one: Runs one mission; importable by name, or a `functools.partial` of such a function.
        out: Folder of the results, see `zavis_bt.bench.folder`.
        settings: What else decides the results, as JSON's types; a folder is only resumed with the same.
        workers: Number of processes.
        progress: Show a bar and the success rate so far on standard error, if that is a terminal.

    Returns:
        The results in the order of the tasks.

    Raises:
        InputError: The folder is in use, is not a benchmark's, or holds results of other settings or tasks.
        KeyboardInterrupt: The user pressed Ctrl-C; what was completed is kept, the workers have ended.
    """
    folder = BenchFolder(Path(out), settings, [task.key for task in tasks])
    left = [task for task in tasks if task.key not in folder.done]
    try:
        with _bar(progress) as bar, closing(run_in_processes(partial(_run_task, run_one), left, workers)) as outcomes:
            row = bar.add_task("", total=len(tasks), sr="")
            _show(bar, row, folder)
            for index, outcome in outcomes:
                _keep(folder, left[index], outcome)
                _show(bar, row, folder)
    finally:
        folder.close()
    return folder.results()


def _run_task(run_one: Callable[[Task], MissionResult], task: Task) -> EpisodeResult:
    """Run a mission; in a worker."""
    mission = run_one(task)
    values = {field.name: getattr(mission, field.name) for field in fields(MissionResult)}
    values |= {"id": task.episode.id, "method": task.method, "seed": task.seed, "details": dict(mission.details)}
    result = EpisodeResult(**values, group=task.episode.group)
    return from_line(to_line(result))  # as it will be read again; what cannot be written is a fault of this mission


def _keep(folder: BenchFolder, task: Task, outcome: EpisodeResult | Crash) -> None:
    if isinstance(outcome, EpisodeResult):
        folder.add(outcome)
        return
    result = _crashed(task, outcome)
    folder.add_traceback(result, outcome.traceback)
    folder.add(result)


def _crashed(task: Task, crash: Crash) -> EpisodeResult:
    shortest = task.episode.shortest_path_length
    return EpisodeResult(
        id=task.episode.id,
        method=task.method,
        success=False,
        reason=CRASH + crash.reason,
        spl=None if shortest is None else 0.0,
        path_length=0.0,
        shortest_path_length=shortest,
        waypoints=0,
        candidates=0,
        confirmations=0,
        sim_seconds=0.0,
        wall_seconds=0.0,
        seed=task.seed,
        group=task.episode.group,
    )


def _bar(progress: bool) -> Progress:
    console = Console(stderr=True)
    return Progress(
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[sr]}"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
        disable=not (progress and console.is_terminal),
    )


def _show(bar: Progress, row: Any, folder: BenchFolder) -> None:
    """Update the bar with the number of results and each method's success rate so far."""
    tally: dict[str, list[bool]] = {}
    for result in folder.done.values():
        tally.setdefault(result.method, []).append(result.success)
    rates = (f"{method} {sum(wins) / len(wins):.0%}" for method, wins in sorted(tally.items()))
    crashed = sum(result.crashed for result in folder.done.values())
    text = "SR " + " · ".join(rates) + (f" [red]{crashed} crashed[/red]" if crashed else "")
    bar.update(row, completed=len(folder.done), sr=text if tally else "")
