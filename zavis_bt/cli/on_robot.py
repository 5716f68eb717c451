"""Composing a mission on the robot of a robot file, whose devices drivers play."""

from __future__ import annotations

import gc
import sys
from functools import partial
from pathlib import Path

from zavis_bt.cli.seeing import eyes_of, is_simulated, needs_simulator, with_landmarks_of
from zavis_bt.cli.simulate import Choices, human_of, open_tree
from zavis_bt.knowledge import make_prior, word_vectors
from zavis_bt.mission import DeviceRobot, Mission, Parts, RobotFile, Search, Task, ThreadJobs, WallClock
from zavis_bt.types import MissionResult, Pose2D

_SWITCH = 0.001  # how long a thread may keep the interpreter from another one that must send a command [s]


def has_simulated_camera(file: RobotFile) -> bool:
    """Return whether the camera is the simulator's, whose frames say what they show."""
    return "camera" in file.devices and file.devices["camera"].driver == "sim"


class RobotMission:
    """A mission on a robot, ready to run; its devices are open."""

    def __init__(
        self, choices: Choices, file: RobotFile, start: Pose2D, target: str, task: Task, *, pictures: Path
    ) -> None:
        """Check everything, then open the devices; nothing moves yet.

        Args:
            choices: Tree and models.
            file: The robot.
            start: Where it stands in the map.
            target: What to find.
            task: Names for the result.
            pictures: Where questions at the terminal leave their pictures.

        Raises:
            InputError: Tree, target, start or a name is wrong.
            DeviceError: A device cannot be opened, or says nothing.
        """
        from sim.noise import stream
        from sim.oracle import NamedOracle

        if not has_simulated_camera(file):
            if is_simulated(choices.perception):
                raise needs_simulator(f"{file.path}: --perception {choices.perception}", "--perception neural")
            if choices.confirm == "oracle":
                raise needs_simulator(f"{file.path}: --confirm oracle", "--confirm terminal")
        search = Search(target, choices.known, choices.unknown)
        tree = open_tree(choices, target)
        similarity = word_vectors().similarity
        self._clock, self._jobs = WallClock(), ThreadJobs()
        self.eyes = eyes_of(choices.perception, choices.known, partial(stream, task.seed), similarity)
        human = human_of(choices, NamedOracle(target, similarity), self._clock, pictures)
        prior = make_prior(choices.prior)
        self._robot = DeviceRobot(file, self._clock, start)
        try:
            self._robot.wait_until_ready()
            parts = Parts(
                robot=self._robot,
                clock=self._clock,
                jobs=self._jobs,
                detector=self.eyes.detector,
                matcher=self.eyes.matcher,
                prior=prior,
                human=human,
                rng=stream(task.seed, "planning"),
                thresholds=self.eyes.thresholds,
            )
            self.mission = Mission(tree, parts, with_landmarks_of(self.eyes, search), task, settings=choices.settings)
        except BaseException:
            self.close()
            raise

    def run(self) -> MissionResult:
        """Run to the end.

        Raises:
            KeyboardInterrupt: Ctrl-C; everything is stopped and recorded.
        """
        usual = sys.getswitchinterval()
        sys.setswitchinterval(_SWITCH)
        gc.collect()
        gc.freeze()  # what was loaded stays: later collections are short
        try:
            return self.mission.run()
        finally:
            sys.setswitchinterval(usual)
            gc.unfreeze()
            self.close()

    def close(self) -> None:
        """Stop and release the devices; may be called twice."""
        self._robot.close()
        self._jobs.close()
