"""The cells between which a planner searches."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zavis_bt.planning.costmap import Costmap
from zavis_bt.planning.errors import PlanningError
from zavis_bt.planning.geodesic import ESCAPE
from zavis_bt.types import FloatArray, Pose2D

_GOAL_SNAP = 1.5  # a goal where the robot fits may be this far from a passable cell [cells]


class Endpoints(NamedTuple):
    """Where a path begins and ends, in cells as in `grid_kernels`."""

    start: FloatArray
    """(2,) u, v of the start."""
    goal: FloatArray
    """(2,) u, v of the goal."""
    first: tuple[int, int]
    """Passable cell ``(row, col)`` nearest to the start."""
    last: tuple[int, int]
    """Passable cell nearest to the goal."""
    escapes: bool
    """Whether the robot does not fit at the start, so that the path goes straight to `first` before all else."""


def endpoints(costmap: Costmap, start: Pose2D, goal: Pose2D) -> Endpoints:
    """Find the cells for a start and a goal.

    Raises:
        PlanningError: One of them is not finite, outside of the map, unknown or in an obstacle.
    """
    points = np.array([[start.x, start.y], [goal.x, goal.y]])
    if not np.isfinite(points).all():
        raise PlanningError("start and goal must be finite numbers")
    first = costmap.nearest_passable(start.x, start.y, ESCAPE)
    if first is None:
        raise PlanningError(f"start is {_trouble(costmap, start)}, and nothing within {ESCAPE} m is passable")
    fits = costmap.fits(points, slack=costmap.slack)
    last = costmap.nearest_passable(goal.x, goal.y, _GOAL_SNAP * costmap.grid.resolution) if fits[1] else None
    if last is None:
        raise PlanningError(f"goal is {_trouble(costmap, goal)}")
    uv = costmap.to_uv(points)
    return Endpoints(uv[0], uv[1], first, last, not fits[0])


def _trouble(costmap: Costmap, pose: Pose2D) -> str:
    """Say why the robot cannot stand at a pose."""
    row, col = costmap.grid.to_cells(np.array([[pose.x, pose.y]]))[0]
    rows, cols = costmap.grid.shape
    if not (0 <= row < rows and 0 <= col < cols):
        return "outside of the map"
    if costmap.barred[row, col]:
        return "in unknown space"
    if costmap.field.obstacle[row, col]:
        return "in an obstacle"
    distance = float(costmap.clearance(np.array([[pose.x, pose.y]]))[0])
    return f"too close to an obstacle ({distance:.2f} m, the robot needs {costmap.radius:.2f} m)"
