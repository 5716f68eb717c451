"""Global planners: a path from a pose to a pose among the obstacles of a costmap."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from types import MappingProxyType
from typing import Protocol

import numpy as np

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.planning.costmap import Costmap
from zavis_bt.types import Path, Pose2D


class GlobalPlanner(Protocol):
    """Finds a path."""

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, rng: np.random.Generator) -> Path:
        """Return a path from the start's position to the goal's; headings do not matter.

        Args:
            costmap: Where the robot fits.
            start: Where the robot is; if it does not fit there, the path begins with a straight line to the nearest
                passable cell.
            goal: Where to go.
            rng: Source of randomness; planners that need none leave it alone.

        Raises:
            PlanningError: There is no path, or none was found.
        """


_PLANNERS = MappingProxyType(
    {
        "astar": "zavis_bt.planning.astar:AStarPlanner",
        "rrt": "zavis_bt.planning.ompl_planner:rrt",
        "rrt_connect": "zavis_bt.planning.ompl_planner:rrt_connect",
        "rrt_star": "zavis_bt.planning.ompl_planner:rrt_star",
        "bit_star": "zavis_bt.planning.ompl_planner:bit_star",
    }
)
"""Where each planner is made; those of OMPL are imported only when they are asked for."""

PLANNERS = tuple(_PLANNERS)
"""Names that `make_planner` knows."""


def make_planner(name: str) -> GlobalPlanner:
    """Return the planner of that name.

    Args:
        name: ``astar``, or one of OMPL's: ``rrt``, ``rrt_connect``, ``rrt_star``, ``bit_star``.

    Raises:
        InputError: No such planner.
    """
    if name not in _PLANNERS:
        raise InputError(f"planner: no planner '{name}'{did_you_mean(name, PLANNERS)}")
    module, _, attribute = _PLANNERS[name].partition(":")
    make: Callable[[], GlobalPlanner] = getattr(importlib.import_module(module), attribute)
    return make()
