"""A simulated robot behind its wires in this process, and the program that drives it in another."""

from __future__ import annotations

import contextlib
import json
import math
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.chaos import ChaosProxy, proxied
from drivers import builtin_robot
from drivers.pioneer.codec import CommandNumber, PacketDecoder, decode_command
from sim.devices.serve import Places, SimulatedDevices
from sim.noise import NoiseSettings
from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.types import Pose2D

_MOTION = {
    CommandNumber.VEL,
    CommandNumber.RVEL,
    CommandNumber.ROTATE,
    CommandNumber.VEL2,
    CommandNumber.MOVE,
    CommandNumber.HEAD,
    CommandNumber.DHEAD,
    CommandNumber.DCHEAD,
}
_STANDS = 0.005  # [m/s]
_STILL = 0.01  # [rad/s]


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion command that the base got."""

    stamp: float
    """`time.monotonic` [s]"""
    connection: int
    number: int
    value: int
    """In the protocol's unit."""


class CommandLog:
    """What motion commands reach the base."""

    def __init__(self) -> None:
        self.motions: list[Motion] = []
        self._decoders: dict[int, PacketDecoder] = {}

    def take(self, stamp: float, connection: int, data: bytes) -> None:
        """Be a proxy's tap."""
        for payload in self._decoders.setdefault(connection, PacketDecoder()).feed(data):
            command = decode_command(payload)
            if command.number in _MOTION and isinstance(command.argument, int):
                self.motions.append(Motion(stamp, connection, command.number, command.argument))

    def moving(self, begin: float, end: float = math.inf, connection: int | None = None) -> list[Motion]:
        """Return the commands of a time that would move the base; only those of connections up to a number if given."""
        return [
            motion
            for motion in self.motions
            if begin <= motion.stamp < end
            and (motion.value or motion.number in (CommandNumber.HEAD, CommandNumber.DHEAD))
            and (connection is None or motion.connection <= connection)
        ]


@dataclass
class Stage:
    """All there is to a robot."""

    devices: SimulatedDevices
    base: ChaosProxy
    lidar: ChaosProxy
    commands: CommandLog
    robot_file: Path
    folder: Path

    @property
    def truth(self) -> Pose2D:
        """Where the base really is."""
        return Pose2D(*self.devices.plant.motion.true)

    @property
    def moves(self) -> bool:
        """Whether the base really moves."""
        motion = self.devices.plant.motion
        return abs(motion.linear) > _STANDS or abs(motion.angular) > _STILL


@contextlib.contextmanager
def stage(
    folder: Path,
    *,
    world: str = "apartment",
    robot: str = "pioneer3at",
    start: int = 0,
    seed: int = 0,
    noise: NoiseSettings | None = None,
) -> Iterator[Stage]:
    """Serve a robot at a start of a world, base and LiDAR through proxies."""
    place = load_world(resolve_world(world))
    port = random.randrange(20_000, 60_000)  # groups on one computer hear one another, ports do not
    places = Places(can_interface="udp_multicast", can_channel="239.74.163.2", can_options={"port": port})
    pose = place.starts[start % len(place.starts)]
    spec = load_robot(builtin_robot(robot)).spec
    with contextlib.ExitStack() as stack:
        devices = stack.enter_context(SimulatedDevices(place, spec, pose, seed=seed, noise=noise, places=places))
        base = stack.enter_context(proxied(("127.0.0.1", devices.base.port)))
        lidar = stack.enter_context(proxied(("127.0.0.1", devices.lidar.port)))
        commands = CommandLog()
        base.tap = commands.take
        ports = {kind: {"port": f"tcp://127.0.0.1:{line.port}"} for kind, line in (("base", base), ("lidar", lidar))}
        yield Stage(devices, base, lidar, commands, devices.robot_file(folder, ports), folder)


class MissionProcess:
    """`zavis run` on the stage's robot."""

    _number = 0

    def __init__(
        self, on: Stage, target: str, *further: str, tree: str = "search", program: tuple[str, ...] = ("-m", "zavis_bt")
    ) -> None:
        """Start it where the robot is; ``program`` is what Python is given in the place of ``zavis``."""
        MissionProcess._number += 1
        self.folder = on.folder / f"run{MissionProcess._number}"
        self._out, self._err = (on.folder / f"mission{MissionProcess._number}.{end}" for end in ("out", "err"))
        pose = on.truth
        start = f"{pose.x:.4f},{pose.y:.4f},{math.degrees(pose.yaw):.3f}"
        command = [sys.executable, *program, "run", tree, "--target", target, "--robot", str(on.robot_file)]
        command += ["--start", start, "--record", str(self.folder), "--json", *further]
        with self._out.open("wb") as out, self._err.open("wb") as err:
            self._process = subprocess.Popen(command, stdout=out, stderr=err, stdin=subprocess.DEVNULL)

    @property
    def ended(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    @property
    def code(self) -> int | None:
        """Its exit code, if it has ended."""
        return self._process.poll()

    @property
    def cpu(self) -> float:
        """Processor time so far [s]; the last known one after its end is lost."""
        fields = Path(f"/proc/{self._process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def send(self, number: signal.Signals) -> None:
        """Send a signal."""
        self._process.send_signal(number)

    def wait(self, seconds: float) -> bool:
        """Return whether it ends in this time."""
        try:
            self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def result(self) -> dict[str, Any] | None:
        """Return the mission's result, if it printed one."""
        for line in reversed(self._out.read_text(encoding="utf-8").splitlines()):
            if line.startswith("{"):
                return dict(json.loads(line))
        return None

    @property
    def last_words(self) -> str:
        """What it said last: the result's reason, or the last line of its errors."""
        result = self.result()
        errors = self._err.read_text(encoding="utf-8", errors="replace").strip().splitlines()
        return str(result["reason"]) if result else (errors[-1] if errors else f"exit code {self.code}")

    def close(self) -> None:
        """Make sure that it is gone."""
        if not self.ended:
            self._process.kill()
        self._process.wait()


def wait_for(condition: Callable[[], bool], seconds: float) -> bool:
    """Return whether a condition comes true in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True
