"""`zavis drive`: a slow test drive from the keyboard."""

from __future__ import annotations

import errno
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

from zavis_bt.errors import DeviceError, InputError

if TYPE_CHECKING:
    from zavis_bt.cli.keyboard import Keyboard
    from zavis_bt.cli.teleop import Look, Teleop
    from zavis_bt.mission import RobotFile, SafeRobot, SafetySettings
    from zavis_bt.protocols import Clock, Robot
    from zavis_bt.types import Pose2D, Twist2D

_HUNG_UP = 129  # exit code of what lost its terminal, as of SIGHUP
_PERIOD = 0.05  # between two looks at the keys [s]
_HELP = """\
  w s ↑ ↓   ahead, back           i k   camera up, down        + -   faster, slower
  a d ← →   turn left, right      j l   camera left, right     q Esc Ctrl-C   leave
  any other key stops             h     camera level
The robot moves only while a key is held: {hold:g} s after the last word of the key it stops."""


def drive(
    robot: Annotated[
        str, typer.Option("--robot", "-r", help="Robot file or profile; one without devices is simulated.")
    ] = "pioneer3at",
    world: Annotated[
        str | None, typer.Option("--world", "-w", help="World to simulate: file or built-in name; else the apartment.")
    ] = None,
    start: Annotated[
        str | None, typer.Option(help="Simulated start x,y,yaw in m, m, degrees; else the world's first.")
    ] = None,
    hold: Annotated[
        float, typer.Option(min=0.1, max=1.5, help="Stop this long after the last word of a key [s].")
    ] = 0.5,
) -> None:
    """Drive slowly with the keyboard; the base moves only while a key is held, and never into what the LiDAR sees."""
    from zavis_bt.cli.drive_view import DriveView
    from zavis_bt.cli.ending import Ended, drop_what_nobody_reads, undisturbed
    from zavis_bt.cli.files import load_robot_file
    from zavis_bt.cli.keyboard import Keyboard
    from zavis_bt.cli.teleop import Teleop

    file, keyboard = load_robot_file(robot), Keyboard()
    try:
        with _opened(file, world, start) as (driven, clock, sees):
            print(_HELP.format(hold=hold))
            teleop = Teleop(driven.spec.limits, hold)
            with keyboard, DriveView() as view:
                loop = Drive(driven, clock, teleop, file.safety, looks=sees)
                try:
                    loop.run(keyboard, view.show)
                finally:
                    with undisturbed():
                        loop.halt()
    except EOFError:
        raise typer.Exit(_HUNG_UP) from None
    except OSError as error:
        if error.errno != errno.EIO:
            raise
        raise typer.Exit(_HUNG_UP) from None
    except Ended as ended:  # nobody may be left to read a word of it
        raise typer.Exit(ended.exit_code) from None
    finally:
        drop_what_nobody_reads()


class Drive:
    """The loop between the keys and the robot, with the safety layer in between."""

    def __init__(
        self, robot: Robot, clock: Clock, teleop: Teleop, safety: SafetySettings, *, looks: bool = True
    ) -> None:
        """Begin at rest.

        Args:
            robot: What is driven.
            clock: Its time.
            teleop: What keys mean.
            safety: When motion is limited or refused.
            looks: Whether there is a pan-tilt unit.
        """
        from zavis_bt.mission import MissionJournal, SafeRobot

        self.teleop, self.looks = teleop, looks
        self.robot: SafeRobot = SafeRobot(robot, safety, MissionJournal(clock), _PERIOD)
        self.problem = ""
        """Why the latest command could not be given."""
        self.wanted: Twist2D | None = None
        """What the keys ask for; None to stand still."""
        self._clock, self._held = clock, False

    @property
    def silent_for(self) -> float:
        """Age of what is known of the base [s]."""
        return self._clock.now() - self.robot.base.latest.stamp

    def run(self, keyboard: Keyboard, show: Callable[[Drive], None]) -> None:
        """Drive until a key to leave is pressed.

        Raises:
            EOFError: The terminal has been closed.
        """
        while not self.teleop.left:
            begin = self._clock.now()
            self.tick(keyboard.pressed())
            show(self)
            self._clock.wait_until(begin + _PERIOD)

    def tick(self, keys: list[str]) -> None:
        """Read the robot, take the keys since the last tick, command it."""
        now = self._clock.now()
        self.robot.base.read(now)
        try:
            looks = [look for key in keys if (look := self.teleop.press(key, now))]
            if looks and self.looks:
                self._look(looks)
            self.wanted = self.teleop.twist(now)
            self._hold_or_let_go()
            if self.wanted is not None:
                self.robot.base.command(self.wanted)
            self.robot.base.flush(now)
            self.problem = ""
        except DeviceError as error:  # its driver goes on trying; the line is shown, and the next key tries again
            self.problem = str(error)

    def halt(self) -> None:
        """Stop everything that moves."""
        self.robot.base.stop()
        if self.looks:
            self.robot.pan_tilt.stop()

    def _hold_or_let_go(self) -> None:
        """Stop as fast as possible where a key says so, until one says to move again."""
        if self.teleop.stop_now:
            self.robot.base.hold()
        elif self._held:
            self.robot.base.resume()
        self._held = self.teleop.stop_now

    def _look(self, looks: list[Look]) -> None:
        """Turn the camera on from where it is now, so that it stops soon after the key is released."""
        unit, limits = self.robot.pan_tilt, self.robot.spec.pan_tilt
        state = unit.state()
        pan, tilt = state.pan, state.tilt
        for look in looks:
            pan, tilt = (0.0, 0.0) if look.level else (pan + look.pan, tilt + look.tilt)
        unit.move_to(min(max(pan, limits.pan_min), limits.pan_max), min(max(tilt, limits.tilt_min), limits.tilt_max))


@contextmanager
def _opened(file: RobotFile, world: str | None, start: str | None) -> Iterator[tuple[Robot, Clock, bool]]:
    """Yield the robot, its clock, and whether it has a pan-tilt unit."""
    from zavis_bt.cli.files import parse_start
    from zavis_bt.mission import WallClock
    from zavis_bt.mission.device_robot import DeviceRobot

    pose = None if start is None else parse_start(start)
    if not file.devices:
        robot, simulated_clock = _simulated(file, world or "apartment", pose)
        yield robot, simulated_clock, True
        return
    for option, value in (("--world", world), ("--start", start)):
        if value is not None:
            raise InputError(f"{option}: {file.path} has devices of its own (leave it out)")
    kinds = [kind for kind in ("base", "lidar", "pan_tilt") if kind in file.devices or kind != "pan_tilt"]
    clock = WallClock()
    devices = DeviceRobot(file, clock, kinds=kinds, opening=lambda kind: print(f"opening {kind} …", flush=True))
    try:
        yield devices, clock, "pan_tilt" in devices.devices
    finally:
        devices.close()


def _simulated(file: RobotFile, world: str, start: Pose2D | None) -> tuple[Robot, Clock]:
    from sim.simulation import Simulation
    from sim.world_file import load_world
    from sim.worlds import resolve_world

    place = load_world(resolve_world(world))
    if start is None and not place.starts:
        raise InputError(f"{world}: the world names no start (give --start x,y,yaw)")
    simulation = Simulation(place, file.spec, start or place.starts[0], real_time=True)
    print(f"{file.spec.name}: no devices in the robot file, so it is simulated in {place.name}")
    return simulation.robot, simulation.clock
