"""What the person at `zavis sim serve` sees and does."""

from __future__ import annotations

import gc
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sim.devices.fault_desk import FaultDesk
from sim.devices.serve import SimulatedDevices
from sim.world import World
from zavis_bt.cli.commands import CommandLine, command_line
from zavis_bt.errors import InputError
from zavis_bt.types import Pose2D

_LOOK, _SAY = 0.1, 1.0  # between two looks at the robot, and two words about it [s]
_SWITCH = 0.001  # how long a thread may keep the interpreter from another one that must answer [s]
_QUIT = ("quit", "exit", "q")


def introduce(devices: SimulatedDevices, world: World, start: Pose2D, robot: str | None, console: Console) -> None:
    """Print what listens where, and what to type next.

    Args:
        devices: They listen already.
        world: Where the robot is.
        start: Where it stands.
        robot: What ``--robot`` must say to find the devices; None if there is no such file.
        console: Where to print.
    """
    place = f"x {start.x:g} y {start.y:g} m, {math.degrees(start.yaw):.0f}°"
    console.print(f"[bold]{escape(devices.plant.spec.name)}[/] in [bold]{escape(world.name)}[/] at {place}\n")
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for title in ("device", "speaks", "at"):
        table.add_column(title)
    for row in _rows(devices):
        table.add_row(*map(escape, row))
    console.print(table)
    console.print(f"\nin another terminal:\n{_next_steps(start, robot)}", soft_wrap=True)
    console.print("\nhere: [bold]help[/] lists the faults you can make, [bold]Ctrl-C[/] or [bold]quit[/] ends\n")


def _rows(devices: SimulatedDevices) -> Iterator[tuple[str, str, str]]:
    settings = devices.settings()
    yield "base", "ARCOS", settings["base"]["settings"]["port"]
    if devices.serial is not None:
        yield "", "ARCOS, serial", devices.serial.path
    yield "LiDAR", "SCIP 2.0", settings["lidar"]["settings"]["port"]
    nodes = devices.pan_tilt.nodes
    port = "".join(f" port {number}" for number in [devices.places.can_options.get("port")] if number)
    bus = f"CAN {devices.places.can_interface} {devices.places.can_channel}{port}"
    yield "pan-tilt", "CANopen, CiA 402", f"{bus}, nodes {nodes['pan']} and {nodes['tilt']}"
    yield "camera", "RGB-D frames", settings["camera"]["settings"]["port"]


def _next_steps(start: Pose2D, robot: str | None) -> str:
    if robot is None:
        return "  no robot file is known to fit: begin again with --write-robot my.robot.yaml, and use that one"
    pose = f"{start.x:g},{start.y:g},{math.degrees(start.yaw):g}"
    commands = (
        f"zavis doctor --robot {robot}",
        f"zavis drive --robot {robot}",
        f'zavis run search --robot {robot} --target "red wallet" --start {pose}',
    )
    return "\n".join(f"  [bold]{escape(command)}[/]" for command in commands)


def attend(devices: SimulatedDevices, world: World, console: Console, *, view: bool) -> None:
    """Take commands and show how things stand, until somebody types ``quit``.

    Raises:
        KeyboardInterrupt: Ctrl-C, or a signal.
    """
    sys.setswitchinterval(_SWITCH)
    gc.collect()
    gc.freeze()  # what was loaded stays: later collections are short
    with (
        closing(FaultDesk(devices)) as desk,
        _shown(devices, world, console, wanted=view) as look,
        command_line(console) as line,
    ):
        due = 0.0
        while not _obey(typed := line.lines(_LOOK), desk, line):
            look()
            if typed or time.monotonic() >= due:
                due = time.monotonic() + _SAY
                line.show(status(devices, desk))


def _obey(lines: Sequence[str], desk: FaultDesk, line: CommandLine) -> bool:
    """Do what was typed; return whether to end."""
    for typed in lines:
        if typed.strip().lower() in _QUIT:
            return True
        try:
            answer = desk.do(typed)
        except InputError as error:
            answer = f"{error} (type 'help')"
        if answer:
            line.say(f"[dim]>[/] {escape(typed.strip())}\n{escape(answer)}")
    return False


def status(devices: SimulatedDevices, desk: FaultDesk) -> str:
    """Return what is broken, pose, speed, joints, and who is connected, in a line."""
    motion = devices.plant.motion
    x, y, yaw = motion.true
    pan, tilt = devices.plant.joints(devices.plant.now)
    return "  ".join(
        [
            *(f"✗ {fault}" for fault in desk.faults),
            f"x {x:.2f} y {y:.2f} m {math.degrees(yaw):.0f}°",
            f"{motion.linear:.2f} m/s {math.degrees(motion.angular):.0f}°/s",
            f"pan {math.degrees(pan):.0f}° tilt {math.degrees(tilt):.0f}°",
            *_connected(devices),
        ]
    )


def _connected(devices: SimulatedDevices) -> Iterator[str]:
    for name, clients in devices.clients().items():
        yield f"{name} {'●' * clients or '○'}"


@contextmanager
def _shown(devices: SimulatedDevices, world: World, console: Console, *, wanted: bool) -> Iterator[Callable[[], None]]:
    """Yield what is to be called often to keep the browser's view up to date."""
    if not wanted:
        yield lambda: None
        return
    from zavis_bt.cli.truth import Truth
    from zavis_bt.viz import MeshcatViewer

    truth = Truth(devices, world)
    with MeshcatViewer(open_browser=console.is_terminal, title=f"{world.name}, as it really is") as viewer:
        console.print(f"live view: {viewer.url}\n", soft_wrap=True)
        viewer.on_start(truth)

        def look() -> None:
            truth.update()
            viewer.on_tick(truth)

        yield look
