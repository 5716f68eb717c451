"""A mission in the built-in flat with a tree of one node, and somebody who watches."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from behaviours import Navigate
from sim.perception import SimDetector, SimMatcher
from sim.simulation import Simulation
from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.cli.files import load_robot_spec
from zavis_bt.mission import InlineJobs, Mission, MissionSettings, Nobody, Parts, Search, Task
from zavis_bt.protocols import Clock, Journal, Robot
from zavis_bt.tree import Behaviour, In, Registry, Status, load_tree
from zavis_bt.types import Box, Candidate, Event, MissionResult, Observed, Pose2D, RgbdFrame, Twist2D, Viewpoint

START = Pose2D(2.4, 2.3, 0.0)
SPEED = 0.2  # [m/s]


class DriveAndLook(Behaviour):
    """Moves base and camera, then ends as it is told; leaves both moving."""

    seconds = In(float, "how long", unit="s", default=math.inf)
    ends = In(str, "success, or the message of what it raises", default="success")

    def setup(self, *, robot: Robot, clock: Clock) -> None:
        self._robot, self._clock = robot, clock

    def initialise(self) -> None:
        self._end = self._clock.now() + self.seconds
        self._robot.pan_tilt.move_to(3.0, 0.5)

    def update(self) -> Status:
        self._robot.base.command(Twist2D(SPEED, 0.3))
        if self._clock.now() < self._end - 1e-9:
            return self.running("driving")
        if self.ends != "success":
            raise ValueError(self.ends)
        return self.succeed("arrived")


class Report(Behaviour):
    """Tells the journal of everything that results count."""

    def setup(self, *, journal: Journal) -> None:
        self._journal = journal

    def update(self) -> Status:
        there = Viewpoint(START, (3.0, 2.0, 0.5), 0.3, 0, "desk")
        self._journal.record("scan")
        self._journal.record("viewpoints", viewpoints=[there])
        self._journal.record("visit", viewpoint=there)
        self._journal.record("visit", viewpoint=there)
        self._journal.record("frontier")
        self._journal.record("candidates", candidates=[candidate(), candidate()])
        self._journal.record("ask", candidates=[candidate()])
        return self.succeed("told")


def candidate() -> Candidate:
    frame = RgbdFrame(
        load_robot_spec("locobot").camera.intrinsics, np.eye(4), 0.0, lambda: pytest.fail("nobody looks at the pixels")
    )
    return Candidate("mug", 30.0, Box(0, 0, 9, 9), (1.0, 1.0, 0.5), frame)


class Watcher:
    """An observer that remembers, and does something at a tick."""

    def __init__(self, *, at: int = 0, act: Callable[[], None] = lambda: None) -> None:
        self.at, self.act = at, act
        self.started = self.ticks = 0
        self.speeds: list[float] = []
        self.results: list[MissionResult] = []

    def on_start(self, mission: Observed) -> None:
        self.started += 1

    def on_tick(self, mission: Observed) -> None:
        self.ticks += 1
        self.speeds.append(mission.base.twist.linear)
        if self.ticks == self.at:
            self.act()

    def on_end(self, mission: Observed, result: MissionResult) -> None:
        self.results.append(result)


class Flat:
    """A mission in the flat, and the simulation it runs in."""

    def __init__(
        self,
        folder: Path,
        node: str,
        *,
        settings: MissionSettings | None = None,
        shortest: float | None = None,
        wrap: Callable[[Robot], Robot] = lambda robot: robot,
    ) -> None:
        path = folder / "own.yaml"
        path.write_text(f"bt: 1\nroot: own\ntrees:\n  own:\n    do:\n      {node}\n")
        self.world = Simulation(load_world(resolve_world("flat")), load_robot_spec("locobot"), START)
        self.parts = Parts(
            robot=wrap(self.world.robot),
            clock=self.world.clock,
            jobs=InlineJobs(self.world.clock),
            detector=SimDetector(("desk",), self.world.rng("detector")),
            matcher=SimMatcher(lambda a, b: float(a == b), self.world.rng("matcher")),
            prior=EvenPrior(),
            human=Nobody(),
            rng=self.world.rng("planning"),
        )
        tree = load_tree(path, Registry([DriveAndLook, Report, Navigate]))
        search, task = Search("mug", ("desk",), ()), Task("flat:mug", "own", 7, shortest)
        self.mission = Mission(tree, self.parts, search, task, settings=settings)
        self.watcher = Watcher()
        self.events: list[Event] = []
        self.mission.observe(self.watcher, self.events.append)

    def assert_stopped(self) -> None:
        """Both come to rest from where they are, sooner than the base's watchdog would see to it."""
        robot, before = self.world.robot, self.world.path_length
        self.world.clock.wait_until(self.world.clock.now() + 0.45)
        assert robot.base.state().twist == Twist2D(0.0, 0.0)
        assert robot.pan_tilt.state().settled
        assert robot.pan_tilt.state().pan < 2.5  # not where it was sent
        assert self.world.path_length - before < 0.05


class EvenPrior:
    def probability(self, target: str, landmarks: Sequence[str]) -> np.ndarray:
        return np.full(len(landmarks), 0.5)
