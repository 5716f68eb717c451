"""Composing a simulated mission: world, robot, perception, prior, person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sim.oracle import Oracle
from sim.simulation import Simulation
from sim.targets import instances_named
from sim.world import World
from zavis_bt.cli.seeing import SIMULATED, check_perception, eyes_of, with_landmarks_of
from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.knowledge import make_prior, word_vectors
from zavis_bt.mission import (
    InlineJobs,
    Mission,
    MissionSettings,
    Nobody,
    Parts,
    Search,
    Task,
    TerminalHuman,
    ThreadJobs,
    TimeStandsStill,
    WithTimeout,
)
from zavis_bt.perception import DEFAULT_KNOWN_LANDMARKS, DEFAULT_UNKNOWN_LANDMARKS
from zavis_bt.protocols import Clock, Human
from zavis_bt.tree import Registry, Tree, load_tree
from zavis_bt.types import MissionResult, Pose2D, RobotSpec

CONFIRMATIONS = ("oracle", "terminal", "timeout")


@dataclass(frozen=True, slots=True)
class Choices:
    """What a user chooses for a simulated mission, beyond world, start and target."""

    tree: Path
    robot: RobotSpec
    method: str
    prior: str = "commonsense"
    perception: str = SIMULATED
    """``simulated``, ``neural``, a plug-in, or an eyes file."""
    confirm: str = "oracle"
    known: tuple[str, ...] = DEFAULT_KNOWN_LANDMARKS
    unknown: tuple[str, ...] = DEFAULT_UNKNOWN_LANDMARKS
    inputs: tuple[tuple[str, Any], ...] = ()
    """Further inputs of the tree, e.g. ``("order", "nearest")``."""
    real_time: bool = False
    settings: MissionSettings = field(default_factory=MissionSettings)

    def __post_init__(self) -> None:
        """Check the names.

        Raises:
            InputError: There is no such kind of perception or confirmation, or an eyes file is wrong.
        """
        check_perception(self.perception)
        if self.confirm not in CONFIRMATIONS:
            raise InputError(f"--confirm: '{self.confirm}' is unknown{did_you_mean(self.confirm, CONFIRMATIONS)}")


class SimulatedMission:
    """A mission in a simulated world, ready to run."""

    def __init__(
        self,
        choices: Choices,
        world: World,
        start: Pose2D,
        target: str,
        task: Task,
        *,
        targets: Sequence[str] | None = None,
        pictures: Path = Path("questions"),
    ) -> None:
        """Compose everything; nothing moves yet.

        Args:
            choices: Tree, robot and models.
            world: Where.
            start: The robot's first pose.
            target: What to find.
            task: Names for the result; its seed is the run's.
            targets: Ids of the instances that count as the target; those the text names if not given.
            pictures: Where questions at the terminal leave their pictures.

        Raises:
            InputError: Tree, target, start or a name is wrong; nothing has moved.
        """
        search = Search(target, choices.known, choices.unknown)
        tree = open_tree(choices, target)
        similarity = word_vectors().similarity
        wanted = instances_named(world, target, similarity) if targets is None else targets
        self.simulation = Simulation(world, choices.robot, start, task.seed, real_time=choices.real_time)
        clock = self.simulation.clock
        self._jobs: ThreadJobs | InlineJobs = ThreadJobs() if choices.real_time else InlineJobs(clock)
        threads = None if choices.real_time else 1  # in lock step, runs are the same whatever the number of cores
        self.eyes = eyes_of(choices.perception, choices.known, self.simulation.rng, similarity, threads=threads)
        parts = Parts(
            robot=self.simulation.robot,
            clock=clock,
            jobs=self._jobs,
            detector=self.eyes.detector,
            matcher=self.eyes.matcher,
            prior=make_prior(choices.prior),
            human=human_of(choices, Oracle(wanted), clock, pictures),
            rng=self.simulation.rng("planning"),
            details=lambda: {"collisions": self.simulation.collisions},
            thresholds=self.eyes.thresholds,
        )
        self.mission = Mission(tree, parts, with_landmarks_of(self.eyes, search), task, settings=choices.settings)

    def run(self) -> MissionResult:
        """Run to the end.

        Raises:
            KeyboardInterrupt: Ctrl-C; everything is stopped and recorded.
        """
        try:
            return self.mission.run()
        finally:
            self.close()

    def close(self) -> None:
        """Stop the robot; may be called twice."""
        self.simulation.robot.close()
        self._jobs.close()


def open_tree(choices: Choices, target: str) -> Tree:
    """Return the tree with its inputs.

    Raises:
        TreeError: It has faults.
    """
    return load_tree(choices.tree, Registry.from_entry_points(), {"target": target, **dict(choices.inputs)})


def human_of(choices: Choices, oracle: Human, clock: Clock, pictures: Path) -> Human:
    """Return who confirms.

    Args:
        choices: Whom the user wants.
        oracle: The simulated person.
        clock: Of the mission.
        pictures: Where questions at the terminal leave their pictures.
    """
    match choices.confirm:
        case "terminal":
            person = TerminalHuman(pictures)
            return person if choices.real_time else TimeStandsStill(person)
        case "timeout":
            return WithTimeout(Nobody(), clock, 30.0, accept=True)
    return oracle
