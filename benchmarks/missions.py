"""Whole missions, as fast as they go: `python -m benchmarks.missions [--episodes FILE] [--real-time]`.

Prints simulated seconds per second on one core, the share of the tree's own ticks, the memory of a `zavis run`, and
what the live view costs. Everything compiled is warm: a mission that is not counted goes first. The wall time is next
to the CPU time, so that a busy machine shows.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from benchmarks.timing import machine, spread, verdict
from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.bench import load_episodes, make_tasks
from zavis_bt.cli.bench import run_episode
from zavis_bt.cli.files import load_robot_spec, resolve_tree
from zavis_bt.cli.simulate import Choices, SimulatedMission
from zavis_bt.mission import MissionSettings, Task
from zavis_bt.tree import Behaviour
from zavis_bt.types import MissionResult

TARGETS = ("mug", "wallet", "laptop", "remote control", "book", "teddy bear")
REAL_SECONDS = 15.0  # of a mission in real time
_MEMORY = """
import sys
from zavis_bt.cli import main
try:
    main()
except SystemExit:
    pass
with open("/proc/self/status") as file:
    print("peak", next(line.split()[1] for line in file if line.startswith("VmHWM")))
"""


@dataclass(frozen=True)
class Spent:
    sim: float
    cpu: float
    wall: float

    def __add__(self, other: Spent) -> Spent:
        return Spent(self.sim + other.sim, self.cpu + other.cpu, self.wall + other.wall)


def compose(seed: int, **choices: Any) -> SimulatedMission:
    """A search in the built-in apartment; start and target change with the seed."""
    world = load_world(resolve_world("apartment"))
    chosen = Choices(resolve_tree("search"), load_robot_spec("locobot"), "search", **choices)
    target = TARGETS[seed % len(TARGETS)]
    return SimulatedMission(chosen, world, world.starts[seed % len(world.starts)], target, Task(target, "search", seed))


def timed(run: Callable[[], MissionResult]) -> tuple[Spent, MissionResult]:
    wall, cpu = time.perf_counter(), time.process_time()
    result = run()
    return Spent(result.sim_seconds, time.process_time() - cpu, time.perf_counter() - wall), result


def row(name: str, spent: Spent, result: MissionResult | None = None) -> None:
    how = "" if result is None else f"  {result.reason} after {result.path_length:.1f} m"
    print(
        f"{name:<34} {spent.sim:8.1f} s {spent.cpu:8.2f} s {spent.sim / spent.cpu:8.0f} × "
        f"{spent.sim / spent.wall:8.0f} ×{how}"
    )


def speed(missions: list[tuple[str, Callable[[], MissionResult]]]) -> None:
    print(f"{'mission':<34} {'simulated':>10} {'CPU':>10} {'sim / CPU':>10} {'sim / wall':>10}")
    total = Spent(0.0, 0.0, 0.0)
    for name, run in missions:
        spent, result = timed(run)
        row(name, spent, result)
        total += spent
    row("all", total)
    print(f"target, at least 100 simulated seconds a second on one core: {verdict(total.sim / total.cpu >= 100)}")


def apartment(seeds: int) -> list[tuple[str, Callable[[], MissionResult]]]:
    names = [f"seed {seed}, {TARGETS[seed % len(TARGETS)]}" for seed in range(seeds)]
    return [(name, compose(seed).run) for seed, name in enumerate(names)]


def from_episodes(file: Path, limit: int | None) -> list[tuple[str, Callable[[], MissionResult]]]:
    choices = {"search": Choices(resolve_tree("search"), load_robot_spec("locobot"), "search")}
    tasks = make_tasks(load_episodes(file)[:limit], ["search"])
    run_episode(choices, tasks[0])
    return [(task.episode.id[:33], lambda task=task: run_episode(choices, task)) for task in tasks]


class Stopwatch:
    """Adds up the time inside wrapped methods, those called by one another only once."""

    def __init__(self) -> None:
        self.total, self.calls = 0.0, 0
        self._depth = 0

    def wrap(self, owner: object, name: str) -> None:
        method = getattr(owner, name)

        def timed_method(*args: Any) -> Any:
            self._depth += 1
            begin = time.perf_counter()
            try:
                return method(*args)
            finally:
                self._depth -= 1
                if self._depth == 0:
                    self.total += time.perf_counter() - begin
                    self.calls += 1

        setattr(owner, name, timed_method)


def watch_cost(calls: int = 20_000) -> float:
    """Return what a watched call costs outside of what its watch counts [s]."""
    watched_object, watch = SimpleNamespace(call=lambda: None), Stopwatch()
    watch.wrap(watched_object, "call")
    begin = time.perf_counter()
    for _ in range(calls):
        watched_object.call()
    return (time.perf_counter() - begin - watch.total) / calls


def overhead(seed: int) -> tuple[float, float]:
    """Return the tree's own share of a mission's wall time, and its own time a tick [s]; less what watching costs."""
    mission = compose(seed)
    tree, ticks, leaves = mission.mission.runner.tree, Stopwatch(), Stopwatch()
    ticks.wrap(tree, "tick")
    for node in tree.root.iterate():
        if isinstance(node, Behaviour):
            for name in ("initialise", "update", "terminate"):
                leaves.wrap(node, name)
    spent, _ = timed(mission.run)
    own = ticks.total - leaves.total - leaves.calls * watch_cost()
    return own / spent.wall, own / ticks.calls


def peak_memory(seed: int) -> float:
    """Return the most that a recorded `zavis run` holds in memory at a time [MiB]."""
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["run", "search", "-t", TARGETS[seed % len(TARGETS)], "-r", "locobot", "--seed", str(seed)]
        done = subprocess.run(
            [sys.executable, "-c", _MEMORY, *arguments, "--record", f"{folder}/run"],
            capture_output=True,
            text=True,
            check=True,
        )
    return int(done.stdout.split("peak ")[1]) / 1024


@contextmanager
def watched(mission: SimulatedMission, wanted: bool) -> Iterator[None]:
    """Attach the live view, served but with no browser open."""
    if not wanted:
        yield
        return
    from zavis_bt.viz import MeshcatViewer

    with MeshcatViewer(port=0) as viewer:
        mission.mission.observe(viewer)
        yield


def view_cost(seeds: int, rounds: int, **choices: Any) -> tuple[list[float], list[float], dict[bool, Spent]]:
    """Return, for missions with and without view in turns: ratios of CPU, of wall time, and the sums."""
    cpu, wall = [], []
    sums = {False: Spent(0.0, 0.0, 0.0), True: Spent(0.0, 0.0, 0.0)}
    for turn in range(rounds):
        both = {False: Spent(0.0, 0.0, 0.0), True: Spent(0.0, 0.0, 0.0)}
        for seed in range(seeds):
            for wanted in (False, True) if (turn + seed) % 2 else (True, False):
                mission = compose(seed, **choices)
                with watched(mission, wanted):
                    both[wanted] += timed(mission.run)[0]
        cpu.append(both[True].cpu / both[False].cpu - 1)
        wall.append(both[True].wall / both[False].wall - 1)
        sums = {wanted: sums[wanted] + both[wanted] for wanted in sums}
    return cpu, wall, sums


def percent(values: list[float]) -> str:
    return spread([100 * value for value in values]) + " %"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.missions", description=__doc__.split("\n")[0])
    parser.add_argument("--episodes", type=Path, metavar="FILE", help="time these instead of the built-in apartment")
    parser.add_argument("--limit", type=int, help="only the first so many episodes")
    parser.add_argument("--seeds", type=int, default=6, help="missions in the apartment (%(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="repeats where two are compared (%(default)s)")
    parser.add_argument("--real-time", action="store_true", help="the view's cost in real time as well (a minute)")
    arguments = parser.parse_args()
    print(machine())
    compose(0).run()
    if arguments.episodes:
        speed(from_episodes(arguments.episodes, arguments.limit))
        return
    speed(apartment(arguments.seeds))
    shares, own = zip(*(overhead(seed) for seed in range(arguments.seeds)), strict=True)
    print(f"tree's own ticks: {percent(list(shares))} of the run, {statistics.median(own) * 1e6:.0f} µs a tick")
    print(f"target, at most 5 %: {verdict(statistics.median(shares) <= 0.05)}")
    peak = max(peak_memory(seed) for seed in range(2))
    print(f"peak memory of a recorded `zavis run`: {peak:.0f} MiB; target, below 600: {verdict(peak < 600)}")
    cpu, wall, _ = view_cost(min(arguments.seeds, 3), arguments.rounds)
    print(f"live view, lock step: {percent(cpu)} more CPU, {percent(wall)} more wall time")
    print(f"target, below 10 %: {verdict(statistics.median(wall) < 0.10)}")
    if arguments.real_time:
        settings = MissionSettings(max_seconds=REAL_SECONDS)
        _, late, sums = view_cost(1, 2, real_time=True, settings=settings)
        load = {wanted: 100 * spent.cpu / spent.wall for wanted, spent in sums.items()}
        print(f"live view, real time: {load[False]:.1f} % of a core without, {load[True]:.1f} % with it; ", end="")
        print(f"{percent(late)} more wall time")


if __name__ == "__main__":
    main()
