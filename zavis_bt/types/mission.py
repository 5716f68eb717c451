"""What a running mission shows, and how it ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, NamedTuple, Protocol

from zavis_bt.types.grid import GridMap
from zavis_bt.types.motion import BaseState, FloatArray, PanTiltState, Path
from zavis_bt.types.robot import RobotSpec
from zavis_bt.types.semantics import Candidate, Landmark, Viewpoint
from zavis_bt.types.sensing import LaserScan


class NodeStatus(StrEnum):
    """State of a tree's node, as py_trees has it."""

    INVALID = "INVALID"
    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILURE = "FAILURE"


@dataclass(frozen=True, slots=True)
class NodeState:
    """A node of the running tree as viewers and logs see it."""

    id: str
    """Path in the tree file, stable over reloads, e.g. ``mission/sequence.1/selector``."""
    name: str
    kind: str
    depth: int
    status: NodeStatus
    reason: str
    """Why it has this status; empty if there is nothing to say."""


class Event(NamedTuple):
    """An entry of the mission's journal."""

    stamp: float
    kind: str
    data: Mapping[str, Any]


class Observed(Protocol):
    """What a viewer or recorder may read after a tick; everything is read-only and cheap to get."""

    @property
    def stamp(self) -> float:
        """Time on the mission's clock [s]."""

    @property
    def robot(self) -> RobotSpec:
        """The robot's model."""

    @property
    def base(self) -> BaseState:
        """Pose in the map, velocity, battery."""

    @property
    def pan_tilt(self) -> PanTiltState:
        """Joint angles."""

    @property
    def scan(self) -> LaserScan | None:
        """Latest LiDAR scan."""

    @property
    def grid(self) -> GridMap:
        """Occupancy map so far; compare ``version``."""

    @property
    def landmarks(self) -> tuple[Landmark, ...]:
        """Semantic map so far."""

    @property
    def nodes(self) -> tuple[NodeState, ...]:
        """The tree, depth first."""

    @property
    def path(self) -> Path | None:
        """Path being followed."""

    @property
    def viewpoints(self) -> tuple[Viewpoint, ...]:
        """Viewpoints still to visit, in their order."""

    @property
    def visited(self) -> tuple[Viewpoint, ...]:
        """Viewpoints visited so far, in their order."""

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """All candidates so far, in the order they were seen."""

    @property
    def found(self) -> Candidate | None:
        """The candidate a person confirmed."""

    @property
    def trajectory(self) -> FloatArray:
        """(n, 2) positions driven so far [m]."""


@dataclass(frozen=True, slots=True)
class MissionResult:
    """How a mission ended: the line that files, ``--json`` and the benchmark write."""

    id: str
    method: str
    success: bool
    reason: str
    spl: float | None
    """Success weighted by path length (Anderson et al. 2018); None where the shortest path is not known."""
    path_length: float
    """[m]"""
    shortest_path_length: float | None
    """[m]"""
    waypoints: int
    """Viewpoints visited."""
    candidates: int
    confirmations: int
    """Times a person was asked."""
    sim_seconds: float
    """Duration on the mission's clock."""
    wall_seconds: float
    seed: int
    details: Mapping[str, Any] = field(default_factory=dict)
    """Further counts: scans, collisions, frontiers."""
