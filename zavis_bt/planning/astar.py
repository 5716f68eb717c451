"""The default planner: A* on the grid, pulled taut."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from zavis_bt.planning.astar_kernels import pull_taut, search
from zavis_bt.planning.costmap import Costmap
from zavis_bt.planning.endpoints import Endpoints, endpoints
from zavis_bt.planning.errors import PlanningError
from zavis_bt.planning.steps import BORDER, steps_of
from zavis_bt.types import FloatArray, Path, Pose2D


class AStarPlanner:
    """Finds the cheapest way over the cells in 16 directions, then straightens it where that costs no more.

    The price of a metre is the costmap's: paths keep off obstacles where the detour is small. Deterministic.
    """

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, rng: np.random.Generator) -> Path:
        """Return a path; see `GlobalPlanner`.

        Raises:
            PlanningError: There is no path.
        """
        ends = endpoints(costmap, start, goal)
        width = costmap.grid.shape[1] + 2 * BORDER
        source, target = ((row + BORDER) * width + col + BORDER for row, col in (ends.first, ends.last))
        cost = np.pad(costmap.cost, BORDER, constant_values=np.inf).ravel()
        tight = np.pad(costmap.tight, BORDER).ravel()
        way = search(cost, tight, costmap.field, costmap.body, steps_of(width), width, source, target)
        if not len(way):
            raise PlanningError("no path: the goal is cut off from the start")
        rows, cols = np.divmod(way, width)
        return finish(costmap, ends, np.column_stack((cols, rows)) - float(BORDER))


def finish(costmap: Costmap, ends: Endpoints, way: FloatArray) -> Path:
    """Turn a way over the grid into a path.

    Args:
        costmap: Where the robot fits.
        ends: Start and goal.
        way: (n, 2) u, v from near the start to near the goal.

    Returns:
        The path from the very start to the very goal, pulled taut; the way out of an obstacle is left as it is.
    """
    points = np.vstack((ends.start, way, ends.goal))
    fixed = 1 if ends.escapes else 0
    taut = pull_taut(
        costmap.field,
        costmap.barred,
        costmap.cost,
        costmap.tight,
        costmap.radius / costmap.grid.resolution,
        points[fixed:],
    )
    taut = np.vstack((points[:fixed], taut))
    return Path(costmap.to_points(_without_repeats(taut)))


def _without_repeats(points: FloatArray) -> FloatArray:
    """Drop points that coincide with the one before; at least two stay."""
    moved: NDArray[np.bool_] = np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-9
    kept = points[np.concatenate(([True], moved))]
    return kept if len(kept) > 1 else points[[0, -1]]
