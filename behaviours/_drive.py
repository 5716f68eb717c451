"""Driving to a pose: plan as a job, follow, plan again when the map says so."""

from __future__ import annotations

from enum import Enum, auto

from behaviours._retreat import Retreat
from zavis_bt.planning import FollowStatus, Navigator, PathFollower, PlanningError
from zavis_bt.protocols import Job, Jobs, Journal, Robot
from zavis_bt.types import Path, Pose2D, Twist2D


class DriveStatus(Enum):
    """Where a drive stands."""

    DRIVING = auto()
    ARRIVED = auto()
    FAILED = auto()


class Drive:
    """One drive to one goal."""

    def __init__(
        self,
        robot: Robot,
        navigator: Navigator,
        jobs: Jobs,
        journal: Journal,
        goal: Pose2D,
        *,
        tolerance: float,
        yaw_tolerance: float | None,
        max_replans: int,
    ) -> None:
        """Start planning.

        Args:
            robot: Who drives.
            navigator: Plans and follows.
            jobs: Where planning runs.
            journal: Told the path.
            goal: Where to stand, map frame.
            tolerance: Accepted distance [m].
            yaw_tolerance: Accepted heading error [rad]; None if the heading does not matter.
            max_replans: How often a blocked path is planned anew.
        """
        self._robot, self._navigator, self._jobs, self._journal = robot, navigator, jobs, journal
        self._goal, self._tolerance, self._yaw_tolerance = goal, tolerance, yaw_tolerance
        self._replans_left = max_replans
        self._follower: PathFollower | None = None
        self._driven = 0.0
        self._twist = Twist2D()
        self._retreat: Retreat | None = None
        self.reason = "planning"
        self._plan: Job[Path] = self._submit()

    @property
    def driven(self) -> float:
        """Distance driven so far [m]."""
        return self._driven + (self._follower.driven if self._follower else 0.0)

    def update(self) -> DriveStatus:
        """Command this tick's twist and return where the drive stands; `reason` says more."""
        if self._follower is None:
            if not self._plan.done():
                return DriveStatus.DRIVING
            try:
                path = self._plan.result()
            except PlanningError as error:
                self.reason = f"unreachable: {error}"
                return DriveStatus.FAILED
            self._journal.record("path", path=path)
            self._follower = self._navigator.follow(
                path, self._goal, tolerance=self._tolerance, yaw_tolerance=self._yaw_tolerance
            )
        state = self._robot.base.state()
        if self._retreat is None and (state.bumper or state.stalled):
            self._retreat = Retreat(self._robot, self._twist)
        if self._retreat is not None:
            return self._get_free(self._retreat)
        progress = self._follower.update(state, self._robot.lidar.scan())
        match progress.status:
            case FollowStatus.ARRIVED:
                return DriveStatus.ARRIVED
            case FollowStatus.DRIVING | FollowStatus.TURNING:
                self._twist = progress.twist
                self._robot.base.command(progress.twist)
                self.reason = f"{progress.remaining:.1f} m to go"
                return DriveStatus.DRIVING
        return self._replan(progress.status)

    def cancel(self) -> None:
        """Stop planning, and slow down to rest."""
        self._plan.cancel()
        self._journal.record("path", path=None)
        self._robot.base.command(Twist2D())

    def _submit(self) -> Job[Path]:
        return self._jobs.submit("plan", self._navigator.plan, self._robot.base.state().pose, self._goal)

    def _get_free(self, retreat: Retreat) -> DriveStatus:
        self.reason = "getting free of what it ran into"
        if not retreat.update():
            return DriveStatus.DRIVING
        self._retreat = None
        return self._replan(FollowStatus.BLOCKED)

    def _replan(self, status: FollowStatus) -> DriveStatus:
        if status is not FollowStatus.INVALID:  # a path that new map made impassable is replaced without limit
            if self._replans_left == 0 or status is FollowStatus.STUCK:
                self.reason = "stuck" if status is FollowStatus.STUCK else "blocked"
                return DriveStatus.FAILED
            self._replans_left -= 1
        self._driven = self.driven
        self._follower, self._plan = None, self._submit()
        self.reason = "planning around an obstacle"
        return DriveStatus.DRIVING
