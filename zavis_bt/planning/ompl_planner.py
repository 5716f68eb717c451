"""Sampling-based planners of the Open Motion Planning Library (I. Sucan, M. Moll, L. Kavraki, 2012).

On a grid in the plane A* is faster and finds shorter paths; these serve to compare, the paper's RRT among them.
"""

from __future__ import annotations

import itertools
import threading
from typing import TYPE_CHECKING, Any

import numpy as np

from zavis_bt.planning.astar import finish
from zavis_bt.planning.costmap import Costmap
from zavis_bt.planning.endpoints import Endpoints, endpoints
from zavis_bt.planning.errors import PlanningError
from zavis_bt.planning.geodesic import GeodesicField
from zavis_bt.planning.grid_kernels import line_fits
from zavis_bt.types import FloatArray, Path, Pose2D

if TYPE_CHECKING:
    from collections.abc import Callable

_SEEDING = threading.Lock()  # OMPL's source of seeds is one for the whole process


class OmplPlanner:
    """A planner of OMPL over the plane; its result is pulled taut like that of A*.

    The search is bounded by iterations and seeded from the generator it is given, so it gives the same path again.
    """

    def __init__(self, algorithm: str, iterations: int) -> None:
        """Choose the algorithm.

        Args:
            algorithm: Name in ``ompl.geometric``.
            iterations: How often it may ask whether to go on; those that improve their path use all of them.
        """
        self._algorithm, self._iterations = algorithm, iterations

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, rng: np.random.Generator) -> Path:
        """Return a path; see `GlobalPlanner`.

        Raises:
            PlanningError: There is no path, or none was found.
        """
        ends = endpoints(costmap, start, goal)
        if not GeodesicField(costmap, start).reachable[ends.last]:
            raise PlanningError("no path: the goal is cut off from the start")
        with _SEEDING:
            way = self._solve(costmap, ends, int(rng.integers(1, 2**31)))
        if way is None:
            raise PlanningError(f"no path found in {self._iterations} iterations of {self._algorithm}")
        return finish(costmap, ends, _dense(way))

    def _solve(self, costmap: Costmap, ends: Endpoints, seed: int) -> FloatArray | None:
        """Return the (n, 2) u, v of a way, or None if there was none in time."""
        import ompl.base as ob
        import ompl.geometric as og
        import ompl.util as ou

        ou.noOutputHandler()  # its chatter is for developers of planners
        ou.RNG.setSeed(seed)
        rows, cols = costmap.grid.shape
        bounds = ob.RealVectorBounds(2)
        for axis, count in enumerate((cols, rows)):
            bounds.setLow(axis, -0.5)
            bounds.setHigh(axis, count - 0.5 - 1e-9)
        space = ob.RealVectorStateSpace(2)
        space.setBounds(bounds)
        information = ob.SpaceInformation(space)
        information.setStateValidityChecker(_state_validity(costmap))
        motions = _motion_validator(ob, information, costmap)
        information.setMotionValidator(motions)
        information.setup()
        problem = ob.ProblemDefinition(information)
        problem.setStartAndGoalStates(
            _state(information, _in_passable(costmap, ends.start, ends.first)),
            _state(information, _in_passable(costmap, ends.goal, ends.last)),
            1e-6,
        )
        problem.setOptimizationObjective(ob.PathLengthOptimizationObjective(information))
        planner = getattr(og, self._algorithm)(information)
        planner.setProblemDefinition(problem)
        planner.setup()
        planner.solve(ob.PlannerTerminationCondition(_Countdown(self._iterations)))
        if not problem.hasExactSolution():
            return None
        return np.array([(state[0], state[1]) for state in problem.getSolutionPath().getStates()])


class _Countdown:
    """Tells a planner to stop when it has asked so often."""

    def __init__(self, iterations: int) -> None:
        self._left = iterations

    def __call__(self) -> bool:
        self._left -= 1
        return self._left < 0


def _in_passable(costmap: Costmap, point: FloatArray, cell: tuple[int, int]) -> FloatArray:
    """Return the point if its cell is passable, else the middle of the passable cell that stands for it."""
    col, row = np.floor(point + 0.5).astype(int)
    rows, cols = costmap.passable.shape
    if 0 <= row < rows and 0 <= col < cols and costmap.passable[row, col]:
        return point
    return np.array(cell[::-1], dtype=np.float64)


def _state(information: Any, point: FloatArray) -> Any:
    state = information.allocState()
    state[0], state[1] = float(point[0]), float(point[1])
    return state


def _state_validity(costmap: Costmap) -> Callable[[Any], bool]:
    """Return whether a state lies in a passable cell, looked up in bytes: faster from Python than arrays."""
    passable, cols = costmap.passable.tobytes(), costmap.grid.shape[1]

    def is_valid(state: Any) -> bool:
        return passable[int(state[1] + 0.5) * cols + int(state[0] + 0.5)] != 0

    return is_valid


def _motion_validator(ob: Any, information: Any, costmap: Costmap) -> Any:
    """Return OMPL's check of a straight motion, done by a kernel in one go."""
    field, barred, radius = costmap.field, costmap.barred, costmap.radius / costmap.grid.resolution

    class LineValidator(ob.MotionValidator):  # type: ignore[misc]  # the base class is known at run time only
        def checkMotion(self, start: Any, end: Any, *_: Any) -> bool:
            return bool(line_fits(field, barred, radius, start[0], start[1], end[0], end[1]))

    return LineValidator(information)


def _dense(way: FloatArray) -> FloatArray:
    """Return the way with points a cell apart, so that shortcuts can begin and end between its corners."""
    pieces = [way[:1]]
    for begin, end in itertools.pairwise(way):
        count = max(int(np.ceil(np.hypot(*(end - begin)))), 1)
        pieces.append(begin + (end - begin) * (np.arange(1, count + 1) / count)[:, None])
    return np.vstack(pieces)


def rrt() -> OmplPlanner:
    """Rapidly exploring random tree: the paper's global planner."""
    return OmplPlanner("RRT", 50_000)


def rrt_connect() -> OmplPlanner:
    """Two trees that grow towards each other."""
    return OmplPlanner("RRTConnect", 50_000)


def rrt_star() -> OmplPlanner:
    """RRT that goes on to improve its path."""
    return OmplPlanner("RRTstar", 4_000)


def bit_star() -> OmplPlanner:
    """Batch informed trees: improves its path by ordered sampling."""
    return OmplPlanner("BITstar", 4_000)
