"""EstopClear: condition on the emergency stop."""

from __future__ import annotations

from zavis_bt.protocols import Robot
from zavis_bt.tree import Behaviour, Status


class EstopClear(Behaviour):
    """Succeeds while no emergency stop is pressed."""

    def setup(self, *, robot: Robot) -> None:
        """Take the resources."""
        self._robot = robot

    def update(self) -> Status:
        """Read the base."""
        return self.fail("emergency stop pressed") if self._robot.base.state().estop else self.succeed()
