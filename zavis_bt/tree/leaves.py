"""Built-in leaves: ``succeed``, ``fail``, ``wait``."""

from __future__ import annotations

from py_trees.common import Status

from zavis_bt.protocols import Clock
from zavis_bt.tree.behaviour import Behaviour
from zavis_bt.tree.ports import In


class Succeed(Behaviour):
    """Succeed at once, with a reason."""

    reason = In(str, "why", default="")

    def update(self) -> Status:
        """Succeed."""
        return self.succeed(self.reason)


class Fail(Behaviour):
    """Fail at once, with a reason."""

    reason = In(str, "why")

    def update(self) -> Status:
        """Fail."""
        return self.fail(self.reason)


class Wait(Behaviour):
    """Succeed after a while on the mission's clock."""

    seconds = In(float, "how long", unit="s", ge=0.0)

    def setup(self, *, clock: Clock) -> None:
        """Take the mission's clock."""
        self._clock = clock

    def initialise(self) -> None:
        """Start to wait."""
        self._end = self._clock.now() + self.seconds

    def update(self) -> Status:
        """Succeed when the time is over."""
        return self.succeed() if self._clock.now() >= self._end - EPSILON else self.running("waiting")


EPSILON = 1e-9
"""What sums of ticks may lack in the last digits [s]."""

LEAVES: tuple[type[Behaviour], ...] = (Succeed, Fail, Wait)
