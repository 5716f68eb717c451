"""`zavis bench`: many episodes, one or more methods, results that can be compared."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from sim.world import World
    from zavis_bt.bench import Episode, Task
    from zavis_bt.cli.simulate import Choices
    from zavis_bt.types import MissionResult

METHODS = {"zavis": "search", "frontier": "frontier_only"}
"""Names of methods that differ from their tree's; any other method is a tree, by its name or path."""


def bench(
    episodes: Annotated[Path, typer.Argument(help="Episodes file (.jsonl).")],
    method: Annotated[
        list[str], typer.Option("--method", "-m", help="zavis, nearest, frontier, or a tree file; repeat to compare.")
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the results; an interrupted one is resumed.")],
    robot: Annotated[str, typer.Option("--robot", "-r", help="Robot file or profile.")] = "locobot",
    workers: Annotated[int, typer.Option("--workers", "-j", min=1, help="Processes.")] = 1,
    seed: Annotated[int, typer.Option(min=0, help="Of the whole benchmark.")] = 0,
    repeats: Annotated[int, typer.Option(min=1, help="How often each method searches each episode.")] = 1,
    perception: Annotated[
        str, typer.Option(help="Who sees: simulated, neural, a plug-in, or an eyes file.")
    ] = "simulated",
    prior: Annotated[str, typer.Option(help="Commonsense: commonsense, comet, word, none, a plug-in.")] = "commonsense",
    planner: Annotated[str, typer.Option(help="Global planner.")] = "astar",
    max_travel: Annotated[float, typer.Option(min=0.1, help="Give up after this many metres.")] = 50.0,
    limit: Annotated[int | None, typer.Option(min=1, help="Only the first so many episodes.")] = None,
) -> None:
    """Run every method on every episode and print success rate, SPL and the like with 95 % intervals."""
    from rich.console import Console

    from zavis_bt.bench import load_episodes, make_tasks, print_summary, run_benchmark, write_summary
    from zavis_bt.cli.files import load_robot_spec
    from zavis_bt.cli.simulate import Choices
    from zavis_bt.mission import MissionSettings

    trees = {name: _tree(name) for name in method}
    spec = load_robot_spec(robot)
    settings = MissionSettings(planner=planner, max_travel=max_travel)
    common = partial(Choices, robot=spec, perception=perception, prior=prior, settings=settings)
    choices = {name: common(tree=path, method=name) for name, path in trees.items()}
    chosen = load_episodes(episodes)[:limit]  # before anything else reads the file: tells what is wrong with it
    results = run_benchmark(
        make_tasks(chosen, method, seed, repeats),
        partial(run_episode, choices),
        out,
        settings={
            **{"robot": robot, "perception": perception, "prior": prior},
            "eyes": _eyes(perception),
            **{"planner": planner, "max_travel": max_travel, "seed": seed},
            "episodes": _digest([episodes]),
            "trees": {name: _digest(sorted(path.parent.glob("*.yaml"))) for name, path in trees.items()},
        },
        workers=workers,
    )
    write_summary(results, out)
    print_summary(results, Console())


def _eyes(perception: str) -> dict[str, Any]:
    """Return what decides how the eyes see, having opened them: what is wrong is told before the first episode."""
    import numpy as np

    from zavis_bt.cli.seeing import eyes_in_records, eyes_of
    from zavis_bt.knowledge import word_vectors

    rng = np.random.default_rng(0)
    return eyes_in_records(eyes_of(perception, (), lambda _: rng, word_vectors().similarity))


def _tree(method: str) -> Path:
    """Return the method's tree, checked, so that a faulty one is told before the first episode."""
    from zavis_bt.cli.files import resolve_tree
    from zavis_bt.tree import Registry, load_tree

    path = resolve_tree(METHODS.get(method, method))
    load_tree(path, Registry.from_entry_points(), {"target": "anything"})
    return path


def _digest(files: Iterable[Path]) -> str:
    """Return a text that changes when a file does; a tree may include any file beside it."""
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def run_episode(choices: dict[str, Choices], task: Task) -> MissionResult:
    """Run one mission of a benchmark, in whatever process.

    Args:
        choices: What each method is made of.
        task: Episode, method and seed.
    """
    from zavis_bt.cli.simulate import SimulatedMission
    from zavis_bt.mission import Task as MissionTask

    episode, method = task.episode, choices[task.method]
    world = world_of(episode)
    shortest = episode.shortest_path_length
    if shortest is None:
        shortest = _shortest(episode, world)
    mission = SimulatedMission(
        method,
        world,
        episode.start,
        episode.target,
        MissionTask(episode.id, task.method, task.seed, shortest),
        targets=episode.instances,
    )
    return mission.run()


@lru_cache(maxsize=8)
def _empty_world(path: Path) -> World:
    from sim.world_file import load_world

    return load_world(path)


def world_of(episode: Episode) -> World:
    """Return the world of an episode, with the episode's objects in it."""
    from sim.world import WorldObject

    values = (WorldObject(o.id, o.category, o.x, o.y, o.z, o.size, o.on) for o in episode.objects)
    return _empty_world(episode.world).with_objects(values)


def _shortest(episode: Episode, world: World) -> float | None:
    from zavis_bt.bench import shortest_path_length

    start, grid = episode.start, world.grid
    length = shortest_path_length(
        world.occupied, world.walls, grid.resolution, grid.origin, (start.x, start.y), episode.target_positions()
    )
    return length if math.isfinite(length) else None
