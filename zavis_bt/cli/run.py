"""`zavis run`: one mission."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from zavis_bt.cli.simulate import Choices
    from zavis_bt.types import MissionResult, Pose2D

Names = Annotated[str | None, typer.Option(help="Comma-separated landmark names instead of the usual ones.")]


def run(
    tree: Annotated[str, typer.Argument(help="Tree file, or the name of one that comes along, e.g. search.")],
    target: Annotated[str, typer.Option("--target", "-t", help='What to find, e.g. "red wallet".')],
    world: Annotated[str, typer.Option("--world", "-w", help="World file or built-in world.")] = "apartment",
    robot: Annotated[str, typer.Option("--robot", "-r", help="Robot file or profile.")] = "pioneer3at",
    start: Annotated[str | None, typer.Option(help="Start x,y,yaw in m, m, degrees; else the world's first.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness.")] = 0,
    perception: Annotated[str, typer.Option(help="Who sees: simulated.")] = "simulated",
    prior: Annotated[str, typer.Option(help="Commonsense: commonsense, word, none, or a plug-in.")] = "commonsense",
    order: Annotated[str | None, typer.Option(help="Visiting order: greedy, nearest, or a plug-in.")] = None,
    planner: Annotated[
        str, typer.Option(help="Global planner: astar, rrt, rrt_connect, rrt_star, bit_star.")
    ] = "astar",
    confirm: Annotated[str, typer.Option(help="Who answers: oracle, terminal, timeout.")] = "oracle",
    known: Names = None,
    unknown: Names = None,
    set_: Annotated[list[str] | None, typer.Option("--set", help="Input of the tree, name=value; repeat.")] = None,
    max_travel: Annotated[float, typer.Option(min=0.1, help="Give up after this many metres.")] = 50.0,
    max_seconds: Annotated[float, typer.Option(min=1.0, help="Give up after this mission time.")] = 1800.0,
    real_time: Annotated[
        bool, typer.Option("--real-time", help="At the wall clock's pace, not as fast as possible.")
    ] = False,
    view: Annotated[bool, typer.Option("--view", help="Show map, robot and tree live in the browser.")] = False,
    record: Annotated[Path | None, typer.Option(help="Folder for the run; new one under runs/ if not given.")] = None,
    resume: Annotated[Path | None, typer.Option(help="Run folder or map.yaml to go on from.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as one line of JSON.")] = False,
) -> None:
    """Run a mission and say how it went. Exit code 4 if the target was not found."""
    from zavis_bt.cli.files import load_robot_spec, parse_start, resolve_tree, tree_inputs
    from zavis_bt.cli.simulate import Choices
    from zavis_bt.mission import MissionSettings
    from zavis_bt.perception import DEFAULT_KNOWN_LANDMARKS, DEFAULT_UNKNOWN_LANDMARKS

    path = resolve_tree(tree)
    assignments = [*(set_ or []), *([f"order={order}"] if order else [])]
    choices = Choices(
        tree=path,
        robot=load_robot_spec(robot),
        method=path.stem,
        prior=prior,
        perception=perception,
        confirm=confirm,
        known=_names(known, DEFAULT_KNOWN_LANDMARKS),
        unknown=_names(unknown, DEFAULT_UNKNOWN_LANDMARKS),
        inputs=tree_inputs(path, assignments),
        real_time=real_time,
        settings=MissionSettings(planner=planner, max_travel=max_travel, max_seconds=max_seconds),
    )
    pose = None if start is None else parse_start(start)
    result, folder = run_mission(choices, world, target, seed=seed, start=pose, record=record, view=view, resume=resume)
    if as_json:
        print(json.dumps(asdict(result)))
    else:
        report(result, folder)
    if not result.success:
        raise typer.Exit(4)


def run_mission(
    choices: Choices,
    world: str,
    target: str,
    *,
    seed: int,
    start: Pose2D | None,
    record: Path | None,
    view: bool,
    resume: Path | None = None,
) -> tuple[MissionResult, Path]:
    """Run a mission in a simulated world, recorded, and shown if asked for.

    Returns:
        The result and the run folder.
    """
    import logging
    from datetime import datetime

    from sim.world_file import load_world
    from sim.worlds import resolve_world
    from zavis_bt.cli.files import load_maps
    from zavis_bt.cli.simulate import SimulatedMission
    from zavis_bt.cli.viewing import viewer
    from zavis_bt.errors import InputError
    from zavis_bt.mission import Task
    from zavis_bt.recording import RunRecorder, new_run_folder

    place = load_world(resolve_world(world))
    if start is None and not place.starts:
        raise InputError(f"{world}: the world names no start (give --start x,y,yaw)")
    pose = start if start is not None else place.starts[seed % len(place.starts)]
    folder = record or new_run_folder("runs", datetime.now())
    settings = {
        "tree": str(choices.tree),
        "target": target,
        "world": world,
        "start": [pose.x, pose.y, pose.yaw],
        "seed": seed,
        **{
            name: getattr(choices, name) for name in ("prior", "perception", "confirm", "known", "unknown", "real_time")
        },
        "inputs": dict(choices.inputs),
        "robot": choices.robot.name,
        "planner": choices.settings.planner,
        "resume": None if resume is None else str(resume),
    }
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s: %(message)s", stream=sys.stderr)
    task = Task(id=f"{place.name}:{target}", method=choices.method, seed=seed)
    mission = SimulatedMission(choices, place, pose, target, task, pictures=folder / "questions")
    if resume is not None:
        mission.mission.resume(*load_maps(resume))
    recorder = RunRecorder(folder, settings)
    mission.mission.observe(recorder, recorder.on_event)
    with viewer(view, f"find the {target}") as viewers:
        for observer in viewers:
            mission.mission.observe(observer)
        result = mission.run()
    for problem in recorder.problems:
        print(f"not recorded: {problem}", file=sys.stderr)
    return result, folder


def report(result: MissionResult, folder: Path) -> None:
    """Print how a mission went, for people."""
    from rich.console import Console

    console = Console(highlight=False)
    outcome = "[bold green]found[/]" if result.success else f"[bold red]not found[/]: {result.reason}"
    console.print(f"{outcome} after {result.path_length:.1f} m and {result.sim_seconds:.0f} s")
    console.print(
        f"{result.waypoints} viewpoints visited, {result.details.get('scans', 0)} scans, "
        f"{result.candidates} candidates, {result.confirmations} questions"
    )
    console.print(f"run folder: {folder}  (picture: {folder / 'map.png'})", soft_wrap=True)


def _names(text: str | None, default: tuple[str, ...]) -> tuple[str, ...]:
    return default if text is None else tuple(name.strip() for name in text.split(",") if name.strip())
