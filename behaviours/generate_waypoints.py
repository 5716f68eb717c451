"""GenerateWaypoints: decide which landmarks to visit, in which order, and where to stand."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np

from zavis_bt.mapping import Mapper, SemanticMap
from zavis_bt.planning import Navigator, generate_viewpoints, make_order
from zavis_bt.protocols import Job, Jobs, Journal, KnowledgePrior, Robot
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import FloatArray, Landmark, Pose2D, Viewpoint


class GenerateWaypoints(Behaviour):
    """Order viewpoints of the landmarks not yet visited by distance, prior and label uncertainty (Eq. cost).

    Fails with reason ``no landmark left`` if the map has none that is unvisited and reachable, and ``no landmark
    likely`` if the order skips them all.
    """

    target = In(str, "what is looked for")
    order = In(str, "strategy by name: greedy (the paper's), nearest", default="greedy")
    distance = In(str, "distance between viewpoints", default="geodesic", choices=("geodesic", "euclidean"))
    lambda_1 = In(float, "weight of the prior λ1", unit="m", default=3.0, ge=0.0)
    lambda_2 = In(float, "weight of the label's uncertainty λ2", unit="m/nat", default=0.05, ge=0.0)
    t_c = In(float, "skip landmarks less probable than this", default=0.2, ge=0.0, le=1.0)
    t_u = In(float, "skip landmarks more uncertain than this", unit="nat", default=2.5, ge=0.0)
    reach = In(float, "leave landmarks farther than this by path for later", unit="m", default=1000.0, gt=0.0)
    searched_within = In(
        float, "landmarks that were fully in view from nearer count as visited", unit="m", default=2.5, ge=0.0
    )
    persistence = In(
        float,
        "skip landmarks recognised in less than this share of the views that show them",
        default=0.5,
        ge=0.0,
        le=1.0,
    )
    tries = In(int, "give up a landmark that was offered so often and never visited", default=3, ge=1)
    waypoints = Out(list[Viewpoint], "viewpoints in visiting order")

    def setup(
        self,
        *,
        robot: Robot,
        mapper: Mapper,
        navigator: Navigator,
        prior: KnowledgePrior,
        jobs: Jobs,
        journal: Journal,
    ) -> None:
        """Take the resources."""
        self._robot, self._mapper, self._navigator = robot, mapper, navigator
        self._prior, self._jobs, self._journal = prior, jobs, journal
        self._offered: Counter[int] = Counter()
        self._order = make_order(self.order)  # an unknown name is told before anything moves

    def initialise(self) -> None:
        """Start the work on what is known now."""
        landmarks = self._unvisited(self._mapper.semantic)
        pose = self._robot.base.state().pose
        self._job: Job[tuple[int, list[Viewpoint]]] = self._jobs.submit("waypoints", self._plan, pose, landmarks)

    def update(self) -> Status:
        """Wait for the order."""
        if not self._job.done():
            return self.running("ordering viewpoints")
        reachable, ordered = self._job.result()
        self._offered.update(view.landmark for view in ordered)
        self.waypoints = ordered
        self._journal.record("viewpoints", viewpoints=ordered)
        if not ordered:
            return self.fail("no landmark likely" if reachable else "no landmark left")
        return self.succeed(f"{len(ordered)} viewpoints, first {ordered[0].label}")

    def terminate(self, new_status: Status) -> None:
        """Drop the work."""
        self._job.cancel()

    def _unvisited(self, semantic: SemanticMap) -> list[Landmark]:
        """Return the landmarks that exist for all we know and have not been searched."""
        landmarks, grid, views = semantic.landmarks, self._mapper.grid, self._mapper.views
        done = semantic.visited | views.searched(landmarks, grid, self.searched_within)
        left = [each for each in landmarks if each.id not in done and self._offered[each.id] < self.tries]
        chances = views.chances(left, grid)
        return [each for each, n in zip(left, chances, strict=True) if each.views >= self.persistence * n]

    def _plan(self, pose: Pose2D, landmarks: list[Landmark]) -> tuple[int, list[Viewpoint]]:
        costmap, field = self._navigator.costmap, self._navigator.field(pose)
        owners: list[Landmark] = []
        viewpoints: list[Viewpoint] = []
        for landmark in landmarks:
            found = [
                view
                for view in generate_viewpoints(landmark, costmap, field)
                if field.distances(np.array([[view.pose.x, view.pose.y]]))[0] <= self.reach
            ]
            viewpoints += found
            owners += [landmark] * len(found)
        if not viewpoints:
            return 0, []
        prior = self._prior.probability(self.target, [owner.label for owner in owners])
        uncertainty = np.array([owner.entropy for owner in owners])
        indices = self._order(pose, viewpoints, prior, uncertainty, self._distances(viewpoints), **self._weights())
        return len(viewpoints), [viewpoints[i] for i in indices]

    def _weights(self) -> dict[str, float]:
        return {"lambda_1": self.lambda_1, "lambda_2": self.lambda_2, "t_c": self.t_c, "t_u": self.t_u}

    def _distances(self, viewpoints: list[Viewpoint]) -> Callable[[Pose2D], FloatArray]:
        points = np.array([(viewpoint.pose.x, viewpoint.pose.y) for viewpoint in viewpoints])
        if self.distance == "euclidean":
            return lambda pose: np.hypot(points[:, 0] - pose.x, points[:, 1] - pose.y)
        return lambda pose: self._navigator.field(pose).distances(points)
