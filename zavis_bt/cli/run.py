"""`zavis run`: one mission."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from zavis_bt.cli.lists import listed
from zavis_bt.errors import InputError

if TYPE_CHECKING:
    from zavis_bt.cli.on_robot import RobotMission
    from zavis_bt.cli.simulate import Choices, SimulatedMission
    from zavis_bt.mission import RobotFile
    from zavis_bt.types import MissionResult, Pose2D

Names = Annotated[str | None, typer.Option(help="Comma-separated landmark names instead of the usual ones.")]


def run(
    tree: Annotated[str, typer.Argument(help="Tree file, or the name of one that comes along, e.g. search.")],
    target: Annotated[
        str | None, typer.Option("--target", "-t", help='What to find, e.g. "red wallet"; asked for if not given.')
    ] = None,
    world: Annotated[
        str | None, typer.Option("--world", "-w", help="World file or built-in world to simulate; else the apartment.")
    ] = None,
    robot: Annotated[
        str, typer.Option("--robot", "-r", help="Robot file or profile; with devices, the mission runs on them.")
    ] = "pioneer3at",
    start: Annotated[
        str | None, typer.Option(help="Start x,y,yaw in m, m, degrees; else the world's first, or 0,0,0 on a robot.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of all randomness.")] = 0,
    perception: Annotated[
        str | None,
        typer.Option(help="Who sees: simulated, neural, a plug-in, or an eyes file; neural on real cameras."),
    ] = None,
    prior: Annotated[str, typer.Option(help="Commonsense: commonsense, comet, word, none, a plug-in.")] = "commonsense",
    order: Annotated[str | None, typer.Option(help="Visiting order: greedy, nearest, or a plug-in.")] = None,
    planner: Annotated[
        str, typer.Option(help="Global planner: astar, rrt, rrt_connect, rrt_star, bit_star.")
    ] = "astar",
    confirm: Annotated[
        str | None, typer.Option(help="Who answers: oracle (what is simulated), terminal (a robot), timeout.")
    ] = None,
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
    from zavis_bt.cli.files import load_robot_file, parse_start, resolve_tree, tree_inputs
    from zavis_bt.cli.simulate import Choices
    from zavis_bt.mission import MissionSettings
    from zavis_bt.perception import DEFAULT_KNOWN_LANDMARKS, DEFAULT_UNKNOWN_LANDMARKS

    path, file = resolve_tree(tree), load_robot_file(robot)
    assignments = [*(set_ or []), *([f"order={order}"] if order else [])]
    choices = Choices(
        tree=path,
        robot=file.spec,
        method=path.stem,
        prior=prior,
        perception=perception or _who_sees(file),
        confirm=confirm or _who_answers(file),
        known=DEFAULT_KNOWN_LANDMARKS if known is None else listed(known),
        unknown=DEFAULT_UNKNOWN_LANDMARKS if unknown is None else listed(unknown),
        inputs=tree_inputs(path, assignments),
        real_time=real_time or bool(file.devices),
        settings=MissionSettings(planner=planner, max_travel=max_travel, max_seconds=max_seconds, safety=file.safety),
    )
    pose = None if start is None else parse_start(start)
    wanted = _wanted(target)
    if file.devices:
        if world is not None:
            raise InputError(
                f"--world: {file.path} has devices of its own (leave out --world, or choose a robot without)"
            )
        plan = on_robot(choices, file, wanted, seed, pose)
    else:
        plan = simulated(choices, world or "apartment", wanted, seed, pose)
    result, folder = run_mission(plan, record=record, view=view, resume=resume)
    if as_json:
        print(json.dumps(asdict(result)))
    else:
        report(result, folder)
    if not result.success:
        raise typer.Exit(4)


@dataclass(frozen=True, slots=True)
class Plan:
    """A mission that can be composed."""

    target: str
    compose: Callable[[Path], SimulatedMission | RobotMission]
    """Composes it; questions leave their pictures in the folder given."""
    settings: dict[str, Any]
    """What the run folder notes."""


def simulated(choices: Choices, world: str, target: str, seed: int, start: Pose2D | None) -> Plan:
    """Plan a mission in a simulated world.

    Raises:
        InputError: There is no such world, or it names no start and none is given.
    """
    from sim.world_file import load_world
    from sim.worlds import resolve_world
    from zavis_bt.cli.simulate import SimulatedMission
    from zavis_bt.mission import Task

    place = load_world(resolve_world(world))
    if start is None and not place.starts:
        raise InputError(f"{world}: the world names no start (give --start x,y,yaw)")
    pose = start if start is not None else place.starts[seed % len(place.starts)]
    task = Task(id=f"{place.name}:{target}", method=choices.method, seed=seed)
    return Plan(
        target,
        lambda pictures: SimulatedMission(choices, place, pose, target, task, pictures=pictures),
        _settings(choices, target, seed, pose, world=world),
    )


def on_robot(choices: Choices, file: RobotFile, target: str, seed: int, start: Pose2D | None) -> Plan:
    """Plan a mission on the devices of a robot file; they are opened when it is composed."""
    from zavis_bt.cli.on_robot import RobotMission
    from zavis_bt.mission import Task
    from zavis_bt.types import Pose2D

    pose = start or Pose2D(0.0, 0.0)
    task = Task(id=f"{file.spec.name}:{target}", method=choices.method, seed=seed)
    return Plan(
        target,
        lambda pictures: RobotMission(choices, file, pose, target, task, pictures=pictures),
        _settings(choices, target, seed, pose, devices=str(file.path)),
    )


def run_mission(
    plan: Plan, *, record: Path | None, view: bool, resume: Path | None = None
) -> tuple[MissionResult, Path]:
    """Run a mission, recorded, and shown if asked for.

    Returns:
        The result and the run folder.
    """
    import logging
    from datetime import datetime

    from zavis_bt.cli.files import load_maps
    from zavis_bt.cli.seeing import eyes_in_records
    from zavis_bt.cli.viewing import viewer
    from zavis_bt.recording import RunRecorder, new_run_folder

    maps = None if resume is None else load_maps(resume)
    folder = record or new_run_folder("runs", datetime.now())
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s: %(message)s", stream=sys.stderr)
    with closing(plan.compose(folder / "questions")) as composed:
        mission = composed.mission
        if maps is not None:
            mission.resume(*maps)
        recorder = RunRecorder(
            folder,
            {
                **plan.settings,
                "eyes": eyes_in_records(composed.eyes),
                "resume": None if resume is None else str(resume),
            },
        )
        mission.observe(recorder, recorder.on_event)
        with viewer(view, f"find the {plan.target}") as viewers:
            for observer in viewers:
                mission.observe(observer)
            result = composed.run()
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


def _settings(choices: Choices, target: str, seed: int, start: Pose2D, **place: str) -> dict[str, Any]:
    names = "prior", "perception", "confirm", "known", "unknown", "real_time"
    return {
        "tree": str(choices.tree),
        "target": target,
        **place,
        "start": [start.x, start.y, start.yaw],
        "seed": seed,
        **{name: getattr(choices, name) for name in names},
        "inputs": dict(choices.inputs),
        "robot": choices.robot.name,
        "planner": choices.settings.planner,
    }


def _who_answers(file: RobotFile) -> str:
    """Return the person who knows: a simulated one where the scene is simulated, else whoever sits at the terminal."""
    from zavis_bt.cli.on_robot import has_simulated_camera

    return "terminal" if file.devices and not has_simulated_camera(file) else "oracle"


def _who_sees(file: RobotFile) -> str:
    """Return the eyes that suit a robot: simulated ones where frames say what they show."""
    from zavis_bt.cli.on_robot import has_simulated_camera

    return "neural" if file.devices and not has_simulated_camera(file) else "simulated"


def _wanted(target: str | None) -> str:
    """Return what to find, asking for it where somebody can answer."""
    if target is not None:
        return target
    if not sys.stdin.isatty():
        raise InputError('--target: is missing (say what to find, e.g. --target "red wallet")')
    return str(typer.prompt("What shall I find?"))
