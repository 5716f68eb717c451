"""BatteryAbove: condition on the battery."""

from __future__ import annotations

from zavis_bt.protocols import Robot
from zavis_bt.tree import Behaviour, In, Status


class BatteryAbove(Behaviour):
    """Succeeds while the battery holds more than a share of its charge."""

    level = In(float, "state of charge", default=0.2, ge=0.0, le=1.0)

    def setup(self, *, robot: Robot) -> None:
        """Take the resources."""
        self._robot = robot

    def update(self) -> Status:
        """Read the base."""
        battery = self._robot.base.state().battery
        return self.succeed() if battery > self.level else self.fail(f"battery at {battery:.0%}")
