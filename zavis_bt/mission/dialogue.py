"""Asking the person: what has been answered is not asked again."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from zavis_bt.mission.jobs import DoneJob
from zavis_bt.protocols import Human, Job, Journal
from zavis_bt.types import Answer, Candidate


class _Remembered:
    """An answer under way that is noted down when it arrives."""

    def __init__(self, job: Job[Answer], asked: list[Candidate], indices: list[int], rejected: list[Candidate]) -> None:
        self._job, self._asked, self._indices, self._rejected = job, asked, indices, rejected
        self._answer: Answer | None = None

    def done(self) -> bool:
        return self._job.done()

    def result(self) -> Answer:
        if self._answer is None:
            answer = self._job.result()
            if answer.accepted is None:
                self._rejected.extend(self._asked)
                self._answer = answer
            else:
                self._answer = Answer(self._indices[answer.accepted], answer.reason)
        return self._answer

    def cancel(self) -> None:
        self._job.cancel()


class Dialogue:
    """A person who is not bothered twice: candidates near ones already turned down are held back.

    What was turned down from afar, or when its box held only a part of it, is shown again once it is seen much larger.
    """

    def __init__(
        self,
        human: Human,
        journal: Journal,
        *,
        most: int = 5,
        same_place: float = 0.15,
        asks_per_place: int = 2,
        closer: float = 1.5,
    ) -> None:
        """Wrap a person.

        Args:
            human: Who answers.
            journal: Told each question.
            most: How many candidates are shown at once.
            same_place: Candidates closer than this are taken for the same thing [m].
            asks_per_place: How often the same thing is shown: a poor view of the target may be turned down once.
            closer: Views that are this many times larger count afresh, by the square root of the angular area.
        """
        self._human, self._journal, self._most = human, journal, most
        self._same_place, self._asks_per_place, self._closer = same_place, asks_per_place, closer
        self._rejected: list[Candidate] = []

    def news(self, candidates: Sequence[Candidate]) -> list[int]:
        """Return the indices of the candidates worth asking about, in their order, at most ``most``."""
        chosen: list[int] = []
        for i, candidate in enumerate(candidates):
            shown = [*self._rejected, *(candidates[j] for j in chosen)]
            if len(chosen) < self._most and self._times(candidate, shown) < self._asks_per_place:
                chosen.append(i)
        return chosen

    def ask(self, target: str, candidates: Sequence[Candidate]) -> Job[Answer]:
        """Ask about the candidates not yet turned down; answered at once if none is left."""
        indices = self.news(candidates)
        if not indices:
            return DoneJob(Answer(None, "all were turned down before"))
        asked = [candidates[i] for i in indices]
        self._journal.record("ask", candidates=asked)
        return _Remembered(self._human.ask(target, asked), asked, indices, self._rejected)

    def _times(self, candidate: Candidate, shown: Iterable[Candidate]) -> int:
        """Return how often the thing was shown, views apart that are much smaller than this one."""
        least = _extent(candidate) / self._closer
        return sum(
            math.dist(candidate.position, old.position) < self._same_place and _extent(old) > least for old in shown
        )


def _extent(candidate: Candidate) -> float:
    """Return how large the candidate is in its frame, over the focal length: about its angle [rad]."""
    return math.sqrt(candidate.box.area) / candidate.frame.intrinsics.fx
