"""Navigate: drive to a pose."""

from __future__ import annotations

from behaviours._drive import Drive, DriveStatus
from zavis_bt.planning import Navigator
from zavis_bt.protocols import Jobs, Journal, Robot
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import Pose2D, Viewpoint


class Navigate(Behaviour):
    """Drive to a pose along a collision-free path, replanning when the map says so.

    Succeeds within ``tolerance`` of the goal, facing as the goal does. Fails with reason ``unreachable``,
    ``blocked`` or ``stuck``.
    """

    goal = In(Pose2D | Viewpoint, "where to stand, map frame")
    tolerance = In(float, "accepted distance to the goal", unit="m", default=0.15, ge=0.05, le=2.0)
    yaw_tolerance = In(float, "accepted heading error; from π on the heading does not matter", unit="rad", default=0.3)
    replans = In(int, "how often a blocked path is planned anew", default=3, ge=0)
    path_length = Out(float, "driven since the start of this run of the behaviour", unit="m")

    def setup(self, *, robot: Robot, navigator: Navigator, jobs: Jobs, journal: Journal) -> None:
        """Take the resources."""
        self._robot, self._navigator, self._jobs, self._journal = robot, navigator, jobs, journal

    def initialise(self) -> None:
        """Start planning."""
        goal = self.goal.pose if isinstance(self.goal, Viewpoint) else self.goal
        self._drive = Drive(
            self._robot,
            self._navigator,
            self._jobs,
            self._journal,
            goal,
            tolerance=self.tolerance,
            yaw_tolerance=self.yaw_tolerance if self.yaw_tolerance < 3.14 else None,
            max_replans=self.replans,
        )

    def update(self) -> Status:
        """Follow the path."""
        status = self._drive.update()
        self.path_length = self._drive.driven
        if status is DriveStatus.ARRIVED:
            return self.succeed(f"arrived after {self.path_length:.1f} m")
        if status is DriveStatus.FAILED:
            return self.fail(self._drive.reason)
        return self.running(self._drive.reason)

    def terminate(self, new_status: Status) -> None:
        """Stop the base."""
        self._drive.cancel()
