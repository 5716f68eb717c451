"""GoToFrontier: drive to the nearest edge of what is known."""

from __future__ import annotations

import math

import numpy as np

from behaviours._drive import Drive, DriveStatus
from zavis_bt.mapping import Mapper, find_frontiers, frontier_goal
from zavis_bt.planning import Navigator
from zavis_bt.protocols import Job, Jobs, Journal, Robot
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import Pose2D


class GoToFrontier(Behaviour):
    """Drive to the reachable frontier that is nearest by path.

    A frontier is a cluster of free cells beside unknown ones; its goal is its reachable member nearest its middle.
    Frontiers that were reached or could not be reached before are left out: what stays unknown there cannot be seen.
    Where the drive to one fails, the next is tried. Fails with reason ``nothing left to explore``.
    """

    min_length = In(float, "smallest frontier", unit="m", default=0.3, ge=0.05)
    tolerance = In(float, "accepted distance to the frontier", unit="m", default=0.3, ge=0.05, le=2.0)
    same_place = In(float, "frontiers closer than this to an earlier goal are left out", unit="m", default=0.4, ge=0.0)
    goal = Out(Pose2D, "the frontier's goal, map frame")

    def setup(self, *, robot: Robot, mapper: Mapper, navigator: Navigator, jobs: Jobs, journal: Journal) -> None:
        """Take the resources."""
        self._robot, self._mapper, self._navigator = robot, mapper, navigator
        self._jobs, self._journal = jobs, journal
        self._tried: list[Pose2D] = []

    def initialise(self) -> None:
        """Start the choice."""
        self._choice: Job[Pose2D | None] = self._jobs.submit("plan", self._choose, self._robot.base.state().pose)
        self._drive: Drive | None = None

    def update(self) -> Status:
        """Choose, then drive."""
        if self._drive is None:
            if not self._choice.done():
                return self.running("choosing a frontier")
            goal = self._choice.result()
            if goal is None:
                return self.fail("nothing left to explore")
            self._start(goal)
        assert self._drive is not None
        status = self._drive.update()
        if status is DriveStatus.ARRIVED:
            return self.succeed(f"frontier reached after {self._drive.driven:.1f} m")
        if status is DriveStatus.FAILED:
            return self._try_another()
        return self.running(self._drive.reason)

    def terminate(self, new_status: Status) -> None:
        """Stop the base."""
        self._choice.cancel()
        if self._drive is not None:
            self._drive.cancel()

    def _try_another(self) -> Status:
        assert self._drive is not None
        reason = self._drive.reason
        self._drive.cancel()
        self.initialise()
        return self.running(f"{reason}; trying another frontier")

    def _start(self, goal: Pose2D) -> None:
        self.goal = goal
        self._tried.append(goal)
        self._journal.record("frontier", goal=goal)
        self._drive = Drive(
            self._robot,
            self._navigator,
            self._jobs,
            self._journal,
            goal,
            tolerance=self.tolerance,
            yaw_tolerance=None,
            max_replans=2,
        )

    def _choose(self, pose: Pose2D) -> Pose2D | None:
        field, grid = self._navigator.field(pose), self._mapper.grid
        best, nearest = None, math.inf
        for frontier in find_frontiers(grid, min_length=self.min_length):
            point = frontier_goal(frontier, grid, field.reachable)
            if point is None or any(math.hypot(point[0] - t.x, point[1] - t.y) < self.same_place for t in self._tried):
                continue
            distance = float(field.distances(np.array([point]))[0])
            if distance < nearest:
                best, nearest = Pose2D(point[0], point[1]), distance
        return best
