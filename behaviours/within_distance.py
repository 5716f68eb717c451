"""WithinDistance: condition on where the robot is."""

from __future__ import annotations

import math

from zavis_bt.protocols import Robot
from zavis_bt.tree import Behaviour, In, Status
from zavis_bt.types import Candidate, Pose2D, Viewpoint


class WithinDistance(Behaviour):
    """Succeeds while the robot is near something, measured straight along the floor."""

    of = In(Pose2D | Viewpoint | Candidate, "what to be near to")
    distance = In(float, "how near", unit="m", default=1.0, gt=0.0)

    def setup(self, *, robot: Robot) -> None:
        """Take the resources."""
        self._robot = robot

    def update(self) -> Status:
        """Compare."""
        pose = self._robot.base.state().pose
        match self.of:
            case Pose2D() as goal:
                x, y = goal.x, goal.y
            case Viewpoint() as view:
                x, y = view.pose.x, view.pose.y
            case candidate:
                x, y, _ = candidate.position
        away = math.hypot(x - pose.x, y - pose.y)
        return self.succeed() if away <= self.distance else self.fail(f"{away:.1f} m away")
