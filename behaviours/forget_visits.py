"""ForgetVisits: let the search begin another round over the same furniture."""

from __future__ import annotations

from zavis_bt.mapping import Mapper
from zavis_bt.tree import Behaviour, In, Status


class ForgetVisits(Behaviour):
    """Make visited landmarks eligible again, so that a second look can find what the first one missed.

    Fails with reason ``searched everything`` after ``rounds`` uses, or if the map has no landmark at all.
    """

    rounds = In(int, "how often", default=2, ge=1)

    def setup(self, *, mapper: Mapper) -> None:
        """Take the resources."""
        self._mapper = mapper
        self._used = 0

    def update(self) -> Status:
        """Forget."""
        if self._used >= self.rounds or not self._mapper.semantic.landmarks:
            return self.fail("searched everything")
        self._used += 1
        self._mapper.semantic.forget_visits()
        self._mapper.views.forget_search()
        return self.succeed(f"round {self._used + 1}")
