"""Perception as jobs: frames go in, what they show lands on the semantic map and in the journal."""

from __future__ import annotations

from collections import deque

from zavis_bt.errors import DeviceError
from zavis_bt.mapping import Mapper
from zavis_bt.perception import Perceiver
from zavis_bt.protocols import Job, Jobs, Journal
from zavis_bt.types import Candidate, Percept, RgbdFrame


class Percepts:
    """Frames being looked at, in the order they were taken."""

    def __init__(self, perceiver: Perceiver, mapper: Mapper, jobs: Jobs, journal: Journal, target: str) -> None:
        self._perceiver, self._mapper, self._jobs, self._journal = perceiver, mapper, jobs, journal
        self._target = target
        self._pending: deque[tuple[RgbdFrame, Job[Percept]]] = deque()
        self.candidates: list[Candidate] = []

    def submit(self, frame: RgbdFrame) -> None:
        """Hand a frame to the perceiver."""
        self._pending.append((frame, self._jobs.submit("detect", self._perceiver.perceive, frame, self._target)))

    def poll(self) -> bool:
        """Take in what is done; return whether nothing is left to wait for."""
        while self._pending and self._pending[0][1].done():
            self._take_in(*self._pending.popleft())
        return not self._pending

    def cancel(self) -> None:
        """Forget what is under way."""
        while self._pending:
            self._pending.popleft()[1].cancel()

    def best_first(self) -> list[Candidate]:
        """Return the candidates, highest matching score first."""
        return sorted(self.candidates, key=lambda candidate: -candidate.score)

    def _take_in(self, frame: RgbdFrame, job: Job[Percept]) -> None:
        try:
            percept = job.result()
        except DeviceError as error:  # its pixels were lost on the way; whether the camera is, its health says
            self._journal.record("lost_frame", reason=str(error))
            return
        self._mapper.views.add(frame)
        self._mapper.semantic.integrate(percept.sightings)
        if percept.candidates:
            self.candidates.extend(percept.candidates)
            self._journal.record("candidates", candidates=percept.candidates)
