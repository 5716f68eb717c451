"""Confirm: ask the person whether this is it."""

from __future__ import annotations

from zavis_bt.protocols import Human, Job, Journal
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import Answer, Candidate


class Confirm(Behaviour):
    """Show the candidates to the person, from where they were seen.

    Succeeds with the one that is the target. Fails with reason ``nothing to show`` without candidates, or with the
    person's reason.
    """

    target = In(str, "what is looked for")
    candidates = In(list[Candidate], "what to show, best first")
    found = Out(Candidate, "the confirmed one")

    def setup(self, *, human: Human, journal: Journal) -> None:
        """Take the resources."""
        self._human, self._journal = human, journal

    def initialise(self) -> None:
        """Put the question."""
        self._shown = list(self.candidates)
        self._job: Job[Answer] | None = None
        if self._shown:
            self._job = self._human.ask(self.target, self._shown)

    def update(self) -> Status:
        """Wait for the answer."""
        if self._job is None:
            return self.fail("nothing to show")
        if not self._job.done():
            return self.running("waiting for the person")
        answer = self._job.result()
        if answer.accepted is None:
            return self.fail(answer.reason or "turned down")
        self.found = self._shown[answer.accepted]
        self._journal.record("found", candidate=self.found)
        return self.succeed(answer.reason or "confirmed")

    def terminate(self, new_status: Status) -> None:
        """Withdraw an open question."""
        if self._job is not None:
            self._job.cancel()
