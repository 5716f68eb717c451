"""Faults during a mission over the wire: `python -m benchmarks.faults`.

The simulated devices run in this process, where the truth is known; `zavis run trees/search.yaml` runs in another one
and looks for something that is not there. Once the base drives, a fault begins, lasts some seconds, and is lifted. For
each:

* at rest: from the fault until the base really stands still [s]
* commands: motion commands that reach the base more than half a second after the fault began and while it lasts
* stale: motion commands that a dead line had kept and delivers when it lives again, and how far they move the base
  before the first new one [mm]
* resumed: how often the mission drove again after it, and after how long [s]; else the reason it ended with; it hung if
  it did neither

Where nobody can tell the base to stop, its watchdog makes it slow down as usual, which takes it the time b.
Where bytes are corrupted the mission may drive on with the packets that are whole.
"""

from __future__ import annotations

import argparse
import collections
import json
import signal
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.stage import MissionProcess, Stage, stage, wait_for
from benchmarks.timing import machine, verdict

TARGET = "submarine"
AT_REST = 0.5  # [s]
WATCHDOG = 1.1  # of the base, and a step [s]
JOLT = 0.005  # [m]
_PAUSE = 1.5  # between two faults: what comes back at once counts as the same one [s]
_STILL_FOR = 0.4  # [s]
_TO_DRIVE = 120.0  # a mission must drive again within this time [s]
_TO_END = 10.0  # a process that is told to must end within this time [s]
_BUDGET = ("--max-travel", "100000", "--max-seconds", "100000")


@dataclass(frozen=True, slots=True)
class Fault:
    """What happens, and how it ends."""

    name: str
    begin: Callable[[Stage, MissionProcess], None]
    end: Callable[[Stage, MissionProcess], None] = lambda on, mission: None
    seconds: float = 3.0
    within: float | None = AT_REST
    """By when the base must be at rest [s]; None if it may drive on."""
    ramp: bool = False
    """Whether nobody can tell the base to stop: its watchdog lets it slow down with its usual deceleration."""
    ends_mission: bool = False
    cuts_base: bool = False
    """Whether the connection to the base does not survive it."""


def faults(rng: np.random.Generator) -> list[Fault]:
    unheard: Any = {"within": WATCHDOG, "ramp": True, "seconds": 5.0}
    return [
        Fault("base link cut", lambda on, _: on.base.cut(), lambda on, _: on.base.mend(), cuts_base=True),
        Fault("base link dead", lambda on, _: on.base.hold(), lambda on, _: on.base.mend(), cuts_base=True, **unheard),
        Fault("base silent", lambda on, _: on.base.mute(), lambda on, _: on.base.mend(), cuts_base=True),
        Fault("base 1 % bytes", lambda on, _: on.base.corrupt(0.01, rng), lambda on, _: on.base.mend(), within=None),
        Fault("LiDAR link cut", lambda on, _: on.lidar.cut(), lambda on, _: on.lidar.mend()),
        Fault("LiDAR silent", lambda on, _: on.lidar.mute(), lambda on, _: on.lidar.mend()),
        Fault("LiDAR gone for good", lambda on, _: on.lidar.mute(), lambda on, _: on.lidar.mend(), seconds=14.0),
        Fault("LiDAR 1 % bytes", lambda on, _: on.lidar.corrupt(0.01, rng), lambda on, _: on.lidar.mend(), within=None),
        Fault("CAN node silent", lambda on, _: on.devices.pan_tilt.silence("pan"),
              lambda on, _: on.devices.pan_tilt.resume("pan")),
        Fault("EMCY", lambda on, _: on.devices.pan_tilt.raise_emergency("tilt", 0x8611, 2.0)),
        Fault("camera frozen", lambda on, _: on.devices.camera.freeze(), lambda on, _: on.devices.camera.thaw()),
        Fault("SIGSTOP", lambda _, mission: mission.send(signal.SIGSTOP),
              lambda _, mission: mission.send(signal.SIGCONT), **unheard),
        Fault("SIGTERM", lambda _, mission: mission.send(signal.SIGTERM), ends_mission=True),
        Fault("SIGKILL", lambda _, mission: mission.send(signal.SIGKILL), ends_mission=True, **unheard),
    ]  # fmt: skip


@dataclass
class Injection:
    """How one went."""

    fault: str
    braking: float = 0.0
    """Time that its usual deceleration takes from the greatest speed and rate after the fault [s]."""
    at_rest: float | None = None
    """[s]; None if it was not."""
    commands: int = 0
    stale: int = 0
    jolt: float = 0.0
    """Way driven on stale commands [m]."""
    moved_again: bool = False
    """Whether the base moved after it had come to rest and before the fault was lifted."""
    resumed: float | None = None
    """From the end of the fault until it drove again [s]."""
    ended: str = ""
    hung: bool = False
    samples: list[tuple[float, bool]] = field(default_factory=list)


class Bench:
    """Runs missions, one after the other, and injects faults."""

    def __init__(self, on: Stage) -> None:
        self._on = on
        self._mission: MissionProcess | None = None
        self._missions = 0

    def inject(self, fault: Fault) -> Injection:
        """Wait until the base drives, and inject a fault."""
        on, mission = self._on, self._driving()
        injection = Injection(fault.name)
        connection = on.base.counters.connections
        begun = time.monotonic()
        fault.begin(on, mission)
        injection.samples = self._watch(begun, fault.seconds, injection)
        self._judge_motion(injection)
        lifted = time.monotonic()
        injection.commands = len(on.commands.moving(begun + AT_REST, lifted))
        fault.end(on, mission)
        if fault.ends_mission:
            injection.hung = not mission.wait(_TO_END)
            injection.ended = f"exit {mission.code}"
            self._drop()
            return injection
        if fault.cuts_base:
            self._see_stale(injection, mission, lifted, connection)
        self._see_resumption(injection, mission, lifted)
        return injection

    def close(self) -> None:
        self._drop()

    def _watch(self, begun: float, seconds: float, injection: Injection) -> list[tuple[float, bool]]:
        samples, limits = [], self._on.devices.plant.spec.limits
        while (now := time.monotonic() - begun) < seconds:
            motion = self._on.devices.plant.motion
            ramps = abs(motion.linear) / limits.linear_acceleration, abs(motion.angular) / limits.angular_acceleration
            injection.braking = max(injection.braking, *ramps)
            samples.append((now, self._on.moves))
            time.sleep(0.005)
        return samples

    def _judge_motion(self, injection: Injection) -> None:
        still_since: float | None = None
        for now, moves in injection.samples:
            if injection.at_rest is not None:
                injection.moved_again = injection.moved_again or moves
            elif moves:
                still_since = None
            else:
                still_since = now if still_since is None else still_since
                if now - still_since >= _STILL_FOR:
                    injection.at_rest = still_since

    def _see_stale(self, injection: Injection, mission: MissionProcess, lifted: float, connection: int) -> None:
        """Watch what a line that lives again does until a new connection gives its first command."""
        on, here = self._on, self._on.truth

        def commanded_anew() -> bool:
            fresh = any(motion.connection > connection for motion in on.commands.moving(lifted))
            if not fresh:
                injection.jolt = max(injection.jolt, on.truth.distance(here))
            return fresh or mission.ended

        wait_for(commanded_anew, _TO_DRIVE)
        injection.stale = len(on.commands.moving(lifted, connection=connection))

    def _see_resumption(self, injection: Injection, mission: MissionProcess, lifted: float) -> None:
        if wait_for(lambda: self._drives() or mission.ended, _TO_DRIVE) and not mission.ended:
            injection.resumed = time.monotonic() - lifted
        elif mission.ended:
            injection.ended = mission.last_words
            self._drop()
        else:
            injection.hung = True
            self._drop()

    def _drives(self) -> bool:
        motion = self._on.devices.plant.motion
        return abs(motion.linear) > 0.1 or abs(motion.angular) > 0.2

    def _driving(self) -> MissionProcess:
        """Return a mission that has been driving for a while."""
        since, endings = None, []
        wait_for(lambda: False, _PAUSE)
        end = time.monotonic() + 4 * _TO_DRIVE
        while time.monotonic() < end:
            if self._mission is None or self._mission.ended:
                if self._mission is not None:
                    endings.append(self._mission.last_words)
                    print(f"a mission ended by itself: {endings[-1]}", file=sys.stderr, flush=True)
                self._drop()
                self._missions += 1
                self._mission, since = MissionProcess(self._on, TARGET, "--seed", str(self._missions), *_BUDGET), None
            since = (since or time.monotonic()) if self._drives() else None
            if since and time.monotonic() - since > 0.4:
                return self._mission
            time.sleep(0.01)
        raise SystemExit(f"no mission drives: {endings or 'the last one neither drives nor ends'}")

    def _drop(self) -> None:
        if self._mission is not None:
            self._mission.close()
            self._mission = None


def in_time(fault: Fault, injection: Injection) -> bool:
    """Return whether the base came to rest as soon as it must."""
    if fault.within is None:
        return True
    braking = injection.braking if fault.ramp else 0.0
    return injection.at_rest is not None and injection.at_rest <= fault.within + braking


def row(fault: Fault, injections: Sequence[Injection]) -> tuple[str, bool]:
    """Return a line of the table, and whether all is well in it."""
    rests = [injection.at_rest for injection in injections if injection.at_rest is not None]
    punctual = sum(in_time(fault, injection) for injection in injections)
    commands, stale = sum(each.commands for each in injections), sum(each.stale for each in injections)
    jolt = max(injection.jolt for injection in injections)
    back = [injection.resumed for injection in injections if injection.resumed is not None]
    ended = collections.Counter(injection.ended for injection in injections if injection.ended)
    hung = sum(injection.hung for injection in injections)
    well = punctual == len(injections) and not hung and (fault.within is None or not commands) and jolt < JOLT
    bound = "any" if fault.within is None else f"{fault.within:.1f}{'+b' if fault.ramp else ''}"
    times = f"{statistics.median(rests):6.2f} {max(rests):6.2f}" if rests else f"{'-':>6s} {'-':>6s}"
    resumed = f"{len(back):3d} ({statistics.median(back):4.1f} s)" if back else f"{0:3d}         "
    reasons = "; ".join(f"{count} × {reason}" for reason, count in ended.items())
    return (
        f"{fault.name:19s} {len(injections):3d}  {bound:6s} {times} {punctual:5d} {commands:8d}"
        f" {stale:5d} ({jolt * 1000:3.0f} mm)  {resumed} {hung:5d}  {verdict(well)}  {reasons}",
        well,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--times", type=int, default=20, help="how often each fault is injected")
    parser.add_argument("--only", default="", help="names of faults, comma-separated")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, help="file for one line of JSON an injection")
    arguments = parser.parse_args()
    chosen = [name.strip() for name in arguments.only.split(",") if name.strip()]
    kinds = [fault for fault in faults(np.random.default_rng(arguments.seed)) if not chosen or fault.name in chosen]
    print(machine())
    print("fault                 n  bound  at rest:    max  in time commands stale           resumed       hung")
    well = True
    with tempfile.TemporaryDirectory() as folder, stage(Path(folder), seed=arguments.seed) as on:
        bench = Bench(on)
        try:
            for fault in kinds:
                injections = [_recorded(bench.inject(fault), arguments.out) for _ in range(arguments.times)]
                line, good = row(fault, injections)
                print(line, flush=True)
                well = well and good
        finally:
            bench.close()
    return 0 if well else 1


def _recorded(injection: Injection, out: Path | None) -> Injection:
    if out is not None:
        entry = asdict(injection)
        del entry["samples"]
        with out.open("a", encoding="utf-8") as file:
            file.write(json.dumps(entry) + "\n")
    return injection


if __name__ == "__main__":
    sys.exit(main())
