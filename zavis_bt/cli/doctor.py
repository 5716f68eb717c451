"""`zavis doctor`: whether a robot's devices are well, and what to do where they are not."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from zavis_bt.cli.lists import listed
from zavis_bt.errors import InputError, ZavisError, did_you_mean

if TYPE_CHECKING:
    from rich.console import Console

    from zavis_bt.cli.checkup import Finding
    from zavis_bt.mission import RobotFile
    from zavis_bt.protocols import Clock

_BLIND = "was not moved: that needs a LiDAR that is well, to see that the way is free"
_PATIENCE = 3.0  # so long a LiDAR may take to its first scan [s]
_QUESTION = (
    "The camera will turn by 10° and back; the base will drive 10 cm ahead and back, and turn by 10° and back.\n"
    "Is the robot on the floor, the way free, and a hand on the emergency stop?"
)


def doctor(
    robot: Annotated[
        str | None, typer.Option("--robot", "-r", help="Robot file or profile; without it, only the computer.")
    ] = None,
    only: Annotated[
        str | None, typer.Option(help="Only these devices, comma-separated: base, pan_tilt, lidar, camera.")
    ] = None,
    seconds: Annotated[float, typer.Option(min=0.1, max=600.0, help="How long to watch each device.")] = 3.0,
    move: Annotated[bool, typer.Option("--move", help="Also move each a little, after a question.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the findings as one line of JSON.")] = False,
) -> None:
    """Check a robot: open each device, watch it, name what is wrong. Exit code 1 if anything is. Nothing moves."""
    from rich.console import Console

    from zavis_bt.cli.computer import look_at_computer
    from zavis_bt.cli.files import load_robot_file

    file = None if robot is None else load_robot_file(robot)
    kinds = () if file is None else _chosen(file, only)
    if move:
        _ask()
    console = Console(highlight=False, quiet=as_json)
    computer = look_at_computer()
    console.print("[bold]computer[/]")
    _print_figures(computer.items(), console)
    findings: list[Finding] = []
    for kind in kinds:
        assert file is not None
        finding = _examined(file, kind, seconds, console)
        findings.append(finding)
        _print_finding(finding, console)
    if move and file is not None:
        findings = _moved(file, findings, console)
    if as_json:
        print(json.dumps(_as_data(robot, computer, findings)))
    _print_summary(findings, console)
    if not all(finding.ok for finding in findings):
        raise typer.Exit(1)


def _chosen(file: RobotFile, only: str | None) -> tuple[str, ...]:
    """Return the devices to look at, in the order they are opened."""
    from zavis_bt.mission.device_robot import KINDS

    if not file.devices:
        raise InputError(
            f"{file.path}: has no devices to check, only the simulator plays it "
            "(choose a robot file with devices, e.g. --robot pioneer3at_sim)"
        )
    if only is None:
        return KINDS
    wanted = [name.replace("-", "_") for name in listed(only)]
    for name in wanted:
        if name not in KINDS:
            raise InputError(f"--only: there is no device '{name}'{did_you_mean(name, KINDS)}")
    return tuple(kind for kind in KINDS if kind in wanted)


def _ask() -> None:
    try:
        sure = typer.confirm(_QUESTION, err=True)
    except typer.Abort:
        sure = False
    if not sure:
        raise InputError("--move: not confirmed, so nothing was done (answer y, or leave out --move)")


def _examined(file: RobotFile, kind: str, seconds: float, console: Console) -> Finding:
    from zavis_bt.cli.checkup import examine
    from zavis_bt.mission import WallClock

    with _progress(kind, console) as progress:
        return examine(file, kind, WallClock(), seconds, progress)


def _moved(file: RobotFile, findings: Sequence[Finding], console: Console) -> list[Finding]:
    """Move what could be opened; return the findings with what came of it."""
    sees = any(finding.kind == "lidar" and finding.ok for finding in findings)
    after = []
    for finding in findings:
        if finding.kind in ("base", "pan_tilt") and finding.opened:
            console.print(f"\n[bold]moving {finding.kind}[/]")
            problems = _trial(file, finding.kind) if finding.kind == "pan_tilt" or sees else [_BLIND]
            console.print(*(_marks(problems) or ["  [bold green]✓[/] moves as it is told"]), sep="\n", soft_wrap=True)
            finding = replace(finding, problems=(*finding.problems, *problems))
        after.append(finding)
    return after


def _trial(file: RobotFile, kind: str) -> list[str]:
    from zavis_bt.cli.motion_trial import BaseTrial, try_pan_tilt
    from zavis_bt.mission import WallClock
    from zavis_bt.mission.device_robot import DeviceRobot

    clock = WallClock()
    try:
        with closing(DeviceRobot(file, clock, kinds=("base", "lidar") if kind == "base" else (kind,))) as robot:
            if kind == "base":
                _wait_for(lambda: robot.lidar.scan() is not None, clock)
                return BaseTrial(robot, file.safety, clock).run()
            return try_pan_tilt(robot.pan_tilt, file.spec.pan_tilt, clock)
    except ZavisError as error:
        return [str(error)]


def _wait_for(condition: Callable[[], bool], clock: Clock) -> None:
    end = clock.now() + _PATIENCE
    while not condition() and clock.now() < end:
        clock.wait_until(clock.now() + 0.02)


# -- output ----------------------------------------------------------------------------------------------------------


@contextmanager
def _progress(kind: str, console: Console) -> Iterator[Callable[[float], None]]:
    """Yield what takes the share of the time that has passed; shown at a terminal only, and gone afterwards."""
    if not console.is_terminal or console.quiet:
        yield lambda share: None
        return
    from rich.progress import BarColumn, Progress, TextColumn

    with Progress(
        TextColumn("[bold]{task.description}[/]"), BarColumn(), TextColumn("{task.fields[doing]}"),
        console=console, transient=True,
    ) as bar:  # fmt: skip
        task = bar.add_task(kind, total=1.0, doing="opening …")
        yield lambda share: bar.update(task, completed=share, doing="watching …")


def _print_finding(finding: Finding, console: Console) -> None:
    plate = [finding.model, finding.firmware and f"firmware {finding.firmware}"]
    plate.append(finding.serial and f"serial number {finding.serial}")
    name = ", ".join(part for part in plate if part)
    console.print(f"\n[bold]{finding.kind}[/]  [dim]driver {finding.driver or '-'}[/]  {_escaped(name)}")
    _print_figures(finding.figures.items(), console)
    for line in _marks(finding.problems) or ["  [bold green]✓[/] well"]:
        console.print(line, soft_wrap=True)


def _print_figures(figures: Iterable[tuple[str, str]], console: Console) -> None:
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    for name, value in figures:
        table.add_row(f"  [dim]{_escaped(name)}[/]", _escaped(value))
    console.print(table)


def _marks(problems: Sequence[str]) -> list[str]:
    return [f"  [bold red]✗[/] {_escaped(problem)}" for problem in problems]


def _print_summary(findings: Sequence[Finding], console: Console) -> None:
    ill = [finding.kind for finding in findings if not finding.ok]
    if ill:
        console.print(f"\n[bold red]not well[/]: {', '.join(ill)}")
    elif findings:
        console.print(f"\n[bold green]all well[/]: {', '.join(finding.kind for finding in findings)}")
    else:
        hint = "to check a robot's devices: zavis doctor --robot FILE  (e.g. --robot pioneer3at_sim)"
        console.print(f"\n{hint}", soft_wrap=True)


def _escaped(text: str) -> str:
    from rich.markup import escape

    return escape(text)


def _as_data(robot: str | None, computer: Mapping[str, str], findings: Sequence[Finding]) -> dict[str, Any]:
    return {
        "robot": robot,
        "ok": all(finding.ok for finding in findings),
        "computer": computer,
        "devices": {finding.kind: {"ok": finding.ok, **asdict(finding)} for finding in findings},
    }
