"""Found: condition on the search's success."""

from __future__ import annotations

from zavis_bt.tree import Behaviour, In, Status
from zavis_bt.types import Candidate


class Found(Behaviour):
    """Succeeds once a variable holds a confirmed candidate."""

    candidate = In(Candidate, "variable that `confirm` saves to", default=None)
    otherwise = In(str, "reason to fail with", default="nothing confirmed")

    def update(self) -> Status:
        """Look at the variable."""
        return self.fail(self.otherwise) if self.candidate is None else self.succeed()
