"""Detect: find the target in frames."""

from __future__ import annotations

from behaviours._percepts import Percepts
from zavis_bt.mapping import Mapper
from zavis_bt.perception import Perceiver
from zavis_bt.protocols import Jobs, Journal, Robot
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import Candidate, RgbdFrame


class Detect(Behaviour):
    """Match the detector's boxes with the target's text, in given frames or in the camera's latest one.

    Landmarks in the frames go to the semantic map as well. Succeeds with at least one candidate, fails with reason
    ``not in sight``.
    """

    target = In(str, "what to look for")
    frames = In(list[RgbdFrame], "frames to search; the camera's latest one if not given", default=None)
    candidates = Out(list[Candidate], "what may be the target, best first")

    def setup(self, *, robot: Robot, mapper: Mapper, perceiver: Perceiver, jobs: Jobs, journal: Journal) -> None:
        """Take the resources."""
        self._robot, self._mapper, self._perceiver, self._jobs, self._journal = robot, mapper, perceiver, jobs, journal

    def initialise(self) -> None:
        """Hand the frames to the perceiver."""
        self._percepts = Percepts(self._perceiver, self._mapper, self._jobs, self._journal, self.target)
        self._count = 0
        for frame in self._chosen():
            self._percepts.submit(frame)
            self._count += 1

    def update(self) -> Status:
        """Wait for the perceiver."""
        if self._count == 0:
            return self.fail("no frame from the camera")
        if not self._percepts.poll():
            return self.running("looking at the frames")
        self.candidates = self._percepts.best_first()
        if not self.candidates:
            return self.fail("not in sight")
        return self.succeed(f"{len(self.candidates)} candidates, best {self.candidates[0].score:.1f}")

    def terminate(self, new_status: Status) -> None:
        """Drop what is under way."""
        self._percepts.cancel()

    def _chosen(self) -> list[RgbdFrame]:
        if self.frames is not None:
            return list(self.frames)
        frame = self._robot.camera.frame()
        return [] if frame is None else [frame]
