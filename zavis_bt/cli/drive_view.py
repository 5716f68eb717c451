"""What a driver at the keyboard sees: two lines that are always up to date."""

from __future__ import annotations

import contextlib
import math
import time
from types import TracebackType
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from zavis_bt.types import LaserScan

if TYPE_CHECKING:
    from zavis_bt.cli.drive import Drive

_PERIOD = 0.1  # [s]
_STALE = 1.0  # age of a state that is worth a word [s]


class DriveView:
    """Shows pose, speed, battery, distance to obstacles and faults while somebody drives."""

    def __init__(self, console: Console | None = None) -> None:
        """Prepare to show; ``console`` is the terminal if not given."""
        self._live = Live(console=console or Console(highlight=False), auto_refresh=False)
        self._due = 0.0

    def __enter__(self) -> DriveView:
        self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with contextlib.suppress(OSError):  # the terminal may be gone
            self._live.stop()

    def show(self, drive: Drive) -> None:
        """Bring the lines up to date, at most ten times a second."""
        if time.monotonic() < self._due:
            return
        self._due = time.monotonic() + _PERIOD
        lines = Group(state_line(drive), word_line(drive))
        self._live.update(lines, refresh=True)


def state_line(drive: Drive) -> Text:
    """Return where the robot is, how fast, and how it is."""
    state, scan = drive.robot.base.latest, drive.robot.base.scan
    pose, twist = state.pose, state.twist
    parts = [
        f"x {pose.x:.2f} y {pose.y:.2f} m {math.degrees(pose.yaw):.0f}°",
        f"{twist.linear:.2f} m/s {math.degrees(twist.angular):.0f}°/s of {drive.teleop.speed:.2f}",
        f"battery {state.battery:.0%}",
        f"nearest {nearest(scan)}",
    ]
    if drive.looks:
        unit = drive.robot.pan_tilt.state()
        parts.append(f"pan {math.degrees(unit.pan):.0f}° tilt {math.degrees(unit.tilt):.0f}°")
    return Text("  ".join(parts), no_wrap=True, overflow="ellipsis")


def word_line(drive: Drive) -> Text:
    """Return the first thing that matters now: a fault, why motion is held back, or what the robot does."""
    faults = list(_faults(drive))
    twist = drive.wanted
    if faults:
        text = Text(f"✗ {'; '.join(faults)}", style="bold red")
    elif twist is None:
        text = Text("■ stands: hold a key to move", style="dim")
    elif drive.robot.base.reason:
        text = Text(f"▲ held back: {drive.robot.base.reason}", style="bold yellow")
    else:
        text = Text(f"● {_way(twist.linear, twist.angular)}", style="bold green")
    text.no_wrap, text.overflow = True, "ellipsis"
    return text


def nearest(scan: LaserScan | None) -> str:
    """Return the shortest range of a scan, in words."""
    if scan is None:
        return "no scan"
    seen = scan.ranges[np.isfinite(scan.ranges) & (scan.ranges >= scan.range_min)]
    return f"{seen.min():.2f} m" if len(seen) else "nothing in sight"


def _faults(drive: Drive) -> list[str]:
    state = drive.robot.base.latest
    found = [drive.problem, state.fault or drive.robot.base.trouble]
    found += ["the emergency stop is pressed"] * state.estop
    found += ["a bumper is pressed: only slowly back"] * state.bumper
    found += ["a wheel is held fast: only slowly back"] * state.stalled
    if drive.silent_for > _STALE:
        found.append(f"the base has not been heard of for {drive.silent_for:.0f} s")
    if drive.looks:
        found.append(drive.robot.pan_tilt.state().fault or drive.robot.pan_tilt.trouble)
    return list(dict.fromkeys(fault for fault in found if fault))


def _way(linear: float, angular: float) -> str:
    if linear:
        return "ahead" if linear > 0 else "back"
    return "turns left" if angular > 0 else "turns right"
