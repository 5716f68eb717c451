"""From the command to the first motion: `python -m benchmarks.startup`.

Wall times of fresh processes, next to those of rivals started in turns with them: the bare interpreter, and the
libraries that everything here stands on. The first mission after an installation compiles its kernels, which are kept;
that one is not counted.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time

from benchmarks.timing import machine, spread, verdict

ROUNDS = 7
MISSIONS = 5
TARGET = "wallet"  # not in sight of the start, so that the base must move
_HELP = "import sys; sys.argv = ['zavis', '--help']; from zavis_bt.cli import main; main()"
_PROCESSES = {
    "bare interpreter": "pass",
    "zavis --help": _HELP,
    "import numpy, numba, pydantic, py_trees": "import numpy, numba, pydantic, py_trees",
    "core import": "import zavis_bt.cli.simulate, behaviours, sim",
}
# `zavis run` itself, with an observer in the place of the live view that ends the process when the base first moves.
_FIRST_MOTION = """
import contextlib, os, sys, time
import zavis_bt.cli.viewing

class FirstMotion:
    def on_start(self, mission):
        self.camera, self.base, self.moments = mission.pan_tilt, mission.base.pose, [time.time()]

    def on_tick(self, mission):
        state, pose = mission.pan_tilt, mission.base.pose
        camera = abs(state.pan - self.camera.pan) + abs(state.tilt - self.camera.tilt) > 1e-3
        base = pose.distance(self.base) + abs(pose.yaw - self.base.yaw) > 1e-3
        if (camera or base) and len(self.moments) == 1:
            self.moments.append(time.time())
        if base:
            started = float(os.environ["STARTED"])
            print(*(moment - started for moment in (*self.moments, time.time())), mission.stamp, flush=True)
            os._exit(0)

    def on_end(self, mission, result):
        sys.exit("the base never moved")

@contextlib.contextmanager
def observer(*choices, **others):
    yield [FirstMotion()]

zavis_bt.cli.viewing.viewer = observer
from zavis_bt.cli import main
main()
"""


def seconds(code: str) -> tuple[float, float]:
    """Wall and CPU time of a fresh interpreter that runs this."""
    begin = time.perf_counter()
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    wall = time.perf_counter() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"exit code {process.returncode}: {code}")
    return wall, used.ru_utime + used.ru_stime


def processes() -> dict[str, list[tuple[float, float]]]:
    spent: dict[str, list[tuple[float, float]]] = {name: [] for name in _PROCESSES}
    for turn in range(ROUNDS + 1):
        for name, code in _PROCESSES.items():
            taken = seconds(code)
            if turn:  # the first round fills the file cache
                spent[name].append(taken)
    return spent


def first_motion() -> list[float]:
    """Return when the run began, camera or base moved, the base moved [s after the start], and the mission's clock."""
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["run", "search", "-t", TARGET, "-w", "flat", "-r", "locobot", "--record", f"{folder}/run"]
        done = subprocess.run(
            [sys.executable, "-c", _FIRST_MOTION, *arguments],
            env={**os.environ, "STARTED": repr(time.time())},
            check=True,
            capture_output=True,
            text=True,
        )
    return [float(word) for word in done.stdout.split()]


def main() -> None:
    print(f"wall time, medians (and ranges); {machine()}")
    spent = processes()
    wall = {name: statistics.median(taken for taken, _ in values) for name, values in spent.items()}
    cpu = {name: statistics.median(used for _, used in values) for name, values in spent.items()}
    for name, values in spent.items():
        ratio = cpu[name] / cpu["bare interpreter"]
        print(
            f"{name:<42} {spread([taken for taken, _ in values])} s; CPU {cpu[name]:.2f} s, {ratio:.0f} × the bare one"
        )
    shown, core = wall["zavis --help"], wall["core import"]
    libraries = cpu["import numpy, numba, pydantic, py_trees"]
    print(f"core import takes {cpu['core import'] / libraries:.2f} × the CPU time of its libraries alone")
    print(f"target, help below 0.3 s: {verdict(shown < 0.3)}; target, core import below 1 s: {verdict(core < 1.0)}")
    first_motion()  # compiles where nothing is kept yet
    runs = [first_motion() for _ in range(MISSIONS)]
    begun, moved, drove, stamps = zip(*runs, strict=True)
    print(f"{'zavis run: the mission begins after':<42} {spread(begun)} s")
    print(f"{'zavis run: camera or base moves after':<42} {spread(moved)} s")
    print(f"{'zavis run: the base moves after':<42} {spread(drove)} s, at {stamps[0]:.1f} s of simulated time")
    print(f"target, the base within 2 s: {verdict(statistics.median(drove) <= 2.0)}")


if __name__ == "__main__":
    main()
