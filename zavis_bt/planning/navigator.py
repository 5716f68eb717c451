"""Getting a robot from here to there: plan on the current map, follow the path."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from zavis_bt.planning.costmap import Costmap, Costmaps
from zavis_bt.planning.follower import PathFollower
from zavis_bt.planning.geodesic import GeodesicField
from zavis_bt.planning.planner import make_planner
from zavis_bt.planning.recovery import free_distance
from zavis_bt.planning.shaping import TwistShaper
from zavis_bt.types import GridMap, Path, Pose2D, RobotSpec

_FIELDS = 16  # fields that are kept


class Navigator:
    """Plans and follows paths on a map that grows.

    Costmap and fields are those of the current grid; what was computed is kept until the grid's version changes.
    """

    def __init__(
        self,
        spec: RobotSpec,
        grid: Callable[[], GridMap],
        *,
        planner: str = "astar",
        rng: np.random.Generator | None = None,
        smooth: bool = False,
    ) -> None:
        """Choose a planner.

        Args:
            spec: Robot that drives.
            grid: Returns the current map.
            planner: Name of the global planner.
            rng: Source of randomness for planners that need one; None for a generator of its own with a fixed seed.
            smooth: Whether commands are limited in jerk.

        Raises:
            InputError: No such planner.
        """
        self._spec, self._planner, self._smooth = spec, make_planner(planner), smooth
        self._rng = rng or np.random.default_rng(0)
        self._costmaps = Costmaps(grid, spec.footprint)
        self._fields: dict[tuple[float, float], GeodesicField] = {}
        self._fields_costmap: Costmap | None = None

    @property
    def costmap(self) -> Costmap:
        """Costmap of the current grid."""
        return self._costmaps.current

    def plan(self, start: Pose2D, goal: Pose2D, *, goal_tolerance: float = 0.2) -> Path:
        """Return a path.

        Args:
            start: Where the robot is.
            goal: Where to go.
            goal_tolerance: Where the robot does not fit at the goal, the path may end so far from it [m].

        Raises:
            PlanningError: There is no path.
        """
        costmap = self.costmap
        return self._planner.plan(costmap, start, _nearest_fit(costmap, goal, goal_tolerance), self._rng)

    def field(self, start: Pose2D) -> GeodesicField:
        """Return the path lengths from a start on the current map; the heading does not matter."""
        costmap, key = self.costmap, (start.x, start.y)
        if self._fields_costmap is not costmap or len(self._fields) >= _FIELDS:
            self._fields, self._fields_costmap = {}, costmap
        if key not in self._fields:
            self._fields[key] = GeodesicField(costmap, start)
        return self._fields[key]

    def follow(
        self, path: Path, goal: Pose2D, *, tolerance: float = 0.1, yaw_tolerance: float | None = None
    ) -> PathFollower:
        """Return a follower for the path.

        Args:
            path: From `plan`.
            goal: Where to stand.
            tolerance: Accepted distance [m].
            yaw_tolerance: Accepted heading error [rad]; None if the heading does not matter.
        """
        shaper = TwistShaper(self._spec.limits) if self._smooth else None
        return PathFollower(
            self._spec, self._costmaps, path, goal, tolerance=tolerance, yaw_tolerance=yaw_tolerance, shaper=shaper
        )

    def can_turn(self, pose: Pose2D) -> bool:
        """Tell whether the robot can turn all around on the spot, as far as the map knows."""
        costmap = self.costmap
        if self._spec.footprint.disc:
            return True  # whatever it touches already, it stays as far from
        return bool(costmap.clearance(np.array([[pose.x, pose.y]]))[0] >= costmap.turning_radius)

    def free_behind(self, pose: Pose2D, distance: float) -> float:
        """Return how far the robot can reverse straight, at most ``distance`` [m]."""
        return free_distance(self.costmap, pose, pose.yaw + math.pi, distance)


def _nearest_fit(costmap: Costmap, goal: Pose2D, tolerance: float) -> Pose2D:
    """Return the goal, or the nearest pose within the tolerance where the robot fits if there is one."""
    point = np.array([[goal.x, goal.y]])
    if not np.isfinite(point).all() or costmap.fits(point, slack=costmap.slack)[0]:
        return goal
    cell = costmap.nearest_passable(goal.x, goal.y, tolerance)
    if cell is None:
        return goal
    ((x, y),) = costmap.grid.to_points(np.array([cell], dtype=np.intp))
    return Pose2D(float(x), float(y), goal.yaw)
