"""Missions over the wire, in real time: `python -m benchmarks.wire`.

The simulated devices run in this process, as `zavis sim serve apartment` runs them; `zavis run trees/search.yaml` runs
in another one and finds the red wallet. Base commands are timed where they arrive, the age of scans at the end of each
tick that used them, and odometry is compared with the truth when the mission is over.
"""

from __future__ import annotations

import argparse
import itertools
import json
import resource
import statistics
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.stage import MissionProcess, Motion, Stage, stage, wait_for
from benchmarks.timing import machine, verdict
from drivers.pioneer.codec import CommandNumber
from zavis_bt.types import Pose2D

TARGET = "red wallet"
MISSIONS = 10
SCAN_AGE = 0.1  # [s]
JITTER = 0.005  # [s]
RATES = (10.0, 20.0)  # [Hz]
DRIFT = 0.02  # of the way
_LONGEST = 900.0  # [s]
_BEAT = 0.25  # commands farther apart belong to two motions [s]

# `zavis run` itself, with an observer in the place of the live view that notes what no run folder holds.
_PROGRAM = """
import contextlib, json, resource, sys
import zavis_bt.cli.viewing

class Notes:
    def on_start(self, mission):
        self.ages = []

    def on_tick(self, mission):
        if mission.scan is not None:
            self.ages.append(mission.stamp - mission.scan.stamp)

    def on_end(self, mission, result):
        pose, usage = mission.base.pose, resource.getrusage(resource.RUSAGE_SELF)
        notes = {"ages": self.ages, "pose": [pose.x, pose.y, pose.yaw], "cpu": usage.ru_utime + usage.ru_stime}
        with open(sys.argv[sys.argv.index("--record") + 1] + ".notes.json", "w") as file:
            json.dump(notes, file)

@contextlib.contextmanager
def observer(*choices, **others):
    yield [Notes()]

zavis_bt.cli.viewing.viewer = observer
from zavis_bt.cli import main
main()
"""


@dataclass(frozen=True, slots=True)
class Flight:
    """How one mission went."""

    seed: int
    success: bool
    reason: str
    path: float
    """Really driven [m]."""
    seconds: float
    drift: float
    """Distance of the odometry from the truth at the end, share of the path."""
    rate: float
    """Of base commands [Hz]."""
    jitter: float
    """p99 of how far the time between two commands is from the usual one [s]."""
    scan_age: tuple[float, float]
    """p50 and p99 [s]."""
    cpu: tuple[float, float]
    """Of the mission and of the devices, processors."""

    @property
    def line(self) -> str:
        outcome = "found" if self.success else f"NOT FOUND ({self.reason})"
        p50, p99 = (age * 1000 for age in self.scan_age)
        return (
            f"{self.seed:4d} {self.path:6.1f} m {self.seconds:5.0f} s  drift {self.drift:6.2%}"
            f"  commands {self.rate:5.2f} Hz ± {self.jitter * 1000:5.1f} ms p99  scan age {p50:4.0f} / {p99:4.0f} ms"
            f"  CPU {self.cpu[0]:4.2f} + {self.cpu[1]:4.2f}  {outcome}"
        )


def fly(seed: int, world: str, target: str) -> Flight:
    """Run one mission."""
    with tempfile.TemporaryDirectory() as folder, stage(Path(folder), world=world, start=seed, seed=seed) as on:
        begun, used = time.monotonic(), _own_cpu()
        mission = MissionProcess(on, target, "--seed", str(seed), program=("-c", _PROGRAM))
        try:
            # The truth is looked at before the process ends: closing switches the motors off, nothing else.
            if not mission.wait(_LONGEST):
                return Flight(seed, False, "hung", 0.0, _LONGEST, 0.0, 0.0, 0.0, (0.0, 0.0), (0.0, 0.0))
        finally:
            mission.close()
        seconds, own = time.monotonic() - begun, _own_cpu() - used
        wait_for(lambda: not on.moves, 5.0)
        return _summary(seed, on, mission, seconds, own)


def _summary(seed: int, on: Stage, mission: MissionProcess, seconds: float, own: float) -> Flight:
    result, notes = mission.result(), mission.folder.with_name(mission.folder.name + ".notes.json")
    if result is None or not notes.exists():
        return Flight(seed, False, mission.last_words, 0.0, seconds, 0.0, 0.0, 0.0, (0.0, 0.0), (0.0, own / seconds))
    noted = json.loads(notes.read_text(encoding="utf-8"))
    path = on.devices.plant.motion.travelled
    period, jitter = beat(on.commands.motions)
    p50, p99 = np.quantile(noted["ages"], (0.5, 0.99)).tolist()
    drift = Pose2D(*noted["pose"]).distance(on.truth) / max(path, 1e-9)
    success, reason = bool(result["success"]), str(result["reason"])
    shares = noted["cpu"] / seconds, own / seconds
    return Flight(seed, success, reason, path, seconds, drift, 1 / period, jitter, (p50, p99), shares)


def beat(motions: Sequence[Motion]) -> tuple[float, float]:
    """Return the usual time between two velocities, and the 99 % quantile of the distance from it [s]."""
    stamps = [motion.stamp for motion in motions if motion.number == CommandNumber.VEL]
    gaps = np.array([two - one for one, two in itertools.pairwise(stamps) if two - one < _BEAT])
    usual = float(np.median(gaps))
    return usual, float(np.quantile(np.abs(gaps - usual), 0.99))


def _own_cpu() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--missions", type=int, default=MISSIONS)
    parser.add_argument("--world", default="apartment")
    parser.add_argument("--target", default=TARGET)
    arguments = parser.parse_args()
    print(machine())
    flights = []
    for seed in range(arguments.missions):
        flights.append(fly(seed, arguments.world, arguments.target))
        print(flights[-1].line, flush=True)
    found = sum(flight.success for flight in flights)
    drift, age = max(flight.drift for flight in flights), max(flight.scan_age[1] for flight in flights)
    rates, jitter = [flight.rate for flight in flights], statistics.median(flight.jitter for flight in flights)
    checks = {
        f"found {found} of {len(flights)}": found == len(flights),
        f"odometry within {drift:.2%} of the path (at most {DRIFT:.0%})": drift <= DRIFT,
        f"commands at {min(rates):.1f} to {max(rates):.1f} Hz ({RATES[0]:.0f} to {RATES[1]:.0f})": (
            min(rates) > 0.95 * RATES[0] and max(rates) < 1.05 * RATES[1]
        ),
        f"jitter p99, median mission, {jitter * 1000:.1f} ms (below {JITTER * 1000:.0f})": jitter < JITTER,
        f"scan age p99 {age * 1000:.0f} ms (below {SCAN_AGE * 1000:.0f})": age < SCAN_AGE,
    }
    for text, met in checks.items():
        print(f"{text}: {verdict(met)}")
    return 0 if all(checks.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
