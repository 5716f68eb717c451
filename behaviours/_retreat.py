"""Getting free of what the base ran into."""

from __future__ import annotations

from zavis_bt.protocols import Robot
from zavis_bt.types import Twist2D

_SPEED = 0.1  # [m/s]
_FAR_ENOUGH = 0.15  # [m]
_PATIENCE = 4.0  # [s]


class Retreat:
    """Moves straight away from what was met, against the way the base went."""

    def __init__(self, robot: Robot, went: Twist2D) -> None:
        """Begin where the base is; ``went`` is what it was told when it met something."""
        self._robot = robot
        self._begin = robot.base.state()
        self._twist = Twist2D(_SPEED if went.linear < 0 else -_SPEED, 0.0)

    def update(self) -> bool:
        """Command this tick's twist; return whether the base is free, or gets no further."""
        state = self._robot.base.state()
        touching = state.bumper or state.stalled
        moved = state.pose.distance(self._begin.pose)
        if (moved >= _FAR_ENOUGH and not touching) or state.stamp - self._begin.stamp > _PATIENCE:
            self._robot.base.command(Twist2D())
            return True
        self._robot.base.command(self._twist)
        return False
