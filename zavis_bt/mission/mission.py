"""A mission: one tree, one robot, one thing to find, and how it went."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

from zavis_bt.mapping import Mapper, SemanticMap
from zavis_bt.mission.dialogue import Dialogue
from zavis_bt.mission.health import Health
from zavis_bt.mission.journal import MissionJournal
from zavis_bt.mission.odometer import Odometer
from zavis_bt.mission.orderly_end import OrderlyEnd
from zavis_bt.mission.parts import Parts, Task
from zavis_bt.mission.safety import SafeRobot
from zavis_bt.mission.settings import MissionSettings, Search
from zavis_bt.mission.spl import spl
from zavis_bt.perception import Perceiver
from zavis_bt.planning import Navigator
from zavis_bt.protocols import Observer
from zavis_bt.tree import Outcome, Runner, Status, Tree
from zavis_bt.types import (
    BaseState,
    Candidate,
    Event,
    FloatArray,
    GridMap,
    Landmark,
    LaserScan,
    MissionResult,
    NodeState,
    PanTiltState,
    Path,
    RobotSpec,
    Viewpoint,
)

_LOG = logging.getLogger(__name__)


class Mission:
    """Runs a tree on a robot: reads, maps, ticks, drives, shows, in this order, until it ends.

    Offers itself to observers as `zavis_bt.types.Observed`.
    """

    def __init__(
        self,
        tree: Tree,
        parts: Parts,
        search: Search,
        task: Task,
        *,
        settings: MissionSettings | None = None,
    ) -> None:
        """Compose the mission; nothing moves yet.

        Args:
            tree: The loaded tree; its behaviours get the resources ``robot``, ``clock``, ``jobs``, ``mapper``,
                ``navigator``, ``perceiver``, ``prior``, ``human``, ``journal`` and ``rng``.
            parts: Robot, clock, models and person.
            search: What to look for.
            task: Names for the result.
            settings: Bounds and rates.

        Raises:
            TreeError: A behaviour wants a resource that no mission has.
            InputError: An unknown planner.
        """
        self._settings = settings or MissionSettings()
        self._parts, self._search, self._task, self._tree = parts, search, task, tree
        self._observers: list[Observer] = []
        self.journal = MissionJournal(parts.clock)
        self._robot = SafeRobot(parts.robot, self._settings.safety, self.journal, 1 / self._settings.rate)
        self._health = Health(self._robot, self._settings.safety, self.journal)
        self._mapper = Mapper(parts.robot.spec, self._settings.resolution)
        self._odometer = Odometer()
        navigator = Navigator(
            parts.robot.spec,
            lambda: self._mapper.grid,
            planner=self._settings.planner,
            rng=parts.rng,
            smooth=self._settings.smooth,
        )
        perceiver = Perceiver(
            parts.detector,
            parts.matcher,
            known=search.known,
            unknown=search.unknown,
            thresholds=parts.thresholds,
        )
        tree.setup(
            {
                "robot": self._robot,
                "clock": parts.clock,
                "jobs": parts.jobs,
                "mapper": self._mapper,
                "navigator": navigator,
                "perceiver": perceiver,
                "prior": parts.prior,
                "human": Dialogue(parts.human, self.journal),
                "journal": self.journal,
                "rng": parts.rng,
            }
        )
        self.runner = Runner(
            tree,
            parts.clock,
            rate=self._settings.rate,
            before=[self._sense],
            after=[lambda: self._robot.base.flush(parts.clock.now()), self._check_budget, self._show],
            on_exit=[self._robot.halt],
            hold=lambda: not self._health.well,
            on_pause=self._robot.halt,
            on_resume=self._robot.resume,
        )

    # -- the tick ------------------------------------------------------------------------------------------------

    def _sense(self) -> None:
        base = self._robot.base
        base.read(self._parts.clock.now())
        if self._health.check(self._parts.clock.now()):  # or who knows from where the scan was taken
            self._mapper.update(base.scan, base.latest.pose if base.scan is None else base.pose_at(base.scan.stamp))
            self._odometer.note(base.latest.pose)

    def _check_budget(self) -> None:
        if given_up := self._health.given_up(self._parts.clock.now()):
            self.runner.stop(given_up)
        elif self._odometer.driven > self._settings.max_travel:
            self.runner.stop(f"not found within {self._settings.max_travel:g} m of travel")
        elif self._parts.clock.now() - self._started > self._settings.max_seconds:
            self.runner.stop(f"not found within {self._settings.max_seconds:g} s")

    def _show(self) -> None:
        self._notify(lambda observer: observer.on_tick(self))

    def _notify(self, call: Callable[[Observer], None]) -> None:
        for observer in list(self._observers):
            try:
                call(observer)
            except Exception:  # a viewer's bug must not end the robot's mission: it is logged and dropped
                _LOG.exception("%s failed and is dropped", type(observer).__name__)
                self._observers.remove(observer)

    def observe(self, observer: Observer, events: Callable[[Event], None] | None = None) -> None:
        """Add a viewer or recorder before the run; what it raises is logged, and it is dropped.

        Args:
            observer: Told each tick.
            events: Gets each journal event as it happens.
        """
        self._observers.append(observer)
        if events is not None:
            self.journal.sinks.append(events)

    def resume(self, grid: GridMap, semantic: SemanticMap | None = None) -> None:
        """Begin with the maps of an earlier run; to be called before the run.

        Raises:
            InputError: The map has another resolution.
        """
        self._mapper.seed(grid, semantic)

    # -- the run -------------------------------------------------------------------------------------------------

    def run(self) -> MissionResult:
        """Run to the end.

        Whatever ends the run, the robot is stopped and the observers are told the result.

        Returns:
            How it went.

        Raises:
            KeyboardInterrupt: Ctrl-C, or what SIGTERM and SIGHUP raise; everything was stopped and recorded before.
        """
        wall_start = time.perf_counter()
        self._started = self._parts.clock.now()
        with OrderlyEnd(self.runner.stop) as end:
            self._robot.base.read(self._started)
            self._notify(lambda observer: observer.on_start(self))
            success, reason = False, "interrupted"
            try:
                outcome = self.runner.run()
                success, reason = outcome.status == Status.SUCCESS, self._reason(outcome)
            except KeyboardInterrupt:
                raise
            except BaseException as error:
                reason = f"crash: {type(error).__name__}: {error}"
                raise
            finally:
                end.close()
                self._robot.halt()
                result = self._result(success, reason, time.perf_counter() - wall_start)
                self._notify(lambda observer: observer.on_end(self, result))
        return result

    def _reason(self, outcome: Outcome) -> str:
        if outcome.status == Status.SUCCESS:
            return "found" if self.journal.found is not None else (outcome.reason or "done")
        return f"{outcome.node}: {outcome.reason}" if outcome.node else outcome.reason

    def _result(self, success: bool, reason: str, wall_seconds: float) -> MissionResult:
        counts, shortest = self.journal.counts, self._task.shortest_path_length
        return MissionResult(
            id=self._task.id,
            method=self._task.method,
            success=success,
            reason=reason,
            spl=None if shortest is None else spl(success, self._odometer.driven, shortest),
            path_length=self._odometer.driven,
            shortest_path_length=shortest,
            waypoints=counts["visit"],
            candidates=len(self.journal.candidates),
            confirmations=counts["ask"],
            sim_seconds=self._parts.clock.now() - self._started,
            wall_seconds=wall_seconds,
            seed=self._task.seed,
            details={
                "scans": counts["scan"],
                "frontiers": counts["frontier"],
                "safety_stops": counts["safety"],
                **self._parts.details(),
            },
        )

    # -- what observers see --------------------------------------------------------------------------------------

    @property
    def stamp(self) -> float:
        """Time on the mission's clock [s]."""
        return self._parts.clock.now()

    @property
    def robot(self) -> RobotSpec:
        """The robot's model."""
        return self._robot.spec

    @property
    def base(self) -> BaseState:
        """Pose, velocity, battery."""
        return self._robot.base.latest

    @property
    def pan_tilt(self) -> PanTiltState:
        """Joint angles."""
        return self._robot.pan_tilt.state()

    @property
    def scan(self) -> LaserScan | None:
        """Latest LiDAR scan."""
        return self._robot.base.scan

    @property
    def grid(self) -> GridMap:
        """Occupancy map so far."""
        return self._mapper.grid

    @property
    def landmarks(self) -> tuple[Landmark, ...]:
        """Semantic map so far."""
        return self._mapper.semantic.landmarks

    @property
    def nodes(self) -> tuple[NodeState, ...]:
        """The tree, depth first."""
        return self._tree.nodes()

    @property
    def path(self) -> Path | None:
        """Path being followed."""
        return self.journal.path

    @property
    def viewpoints(self) -> tuple[Viewpoint, ...]:
        """Viewpoints still to visit, in their order."""
        return self.journal.viewpoints

    @property
    def visited(self) -> tuple[Viewpoint, ...]:
        """Viewpoints visited, in their order."""
        return tuple(self.journal.visited)

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """All candidates so far."""
        return tuple(self.journal.candidates)

    @property
    def found(self) -> Candidate | None:
        """The confirmed candidate."""
        return self.journal.found

    @property
    def trajectory(self) -> FloatArray:
        """(n, 2) positions driven so far [m]."""
        return self._odometer.trajectory
