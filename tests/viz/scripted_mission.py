"""A mission that was thought up: an apartment, a robot on its way through it, a tree that changes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from zavis_bt.types import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    BaseLimits,
    BaseState,
    Box,
    CameraIntrinsics,
    CameraSpec,
    Candidate,
    FloatArray,
    Footprint,
    GridMap,
    Landmark,
    LaserScan,
    LidarSpec,
    MissionResult,
    NodeState,
    NodeStatus,
    PanTiltSpec,
    PanTiltState,
    Path,
    Pose2D,
    RgbdFrame,
    RobotSpec,
    Twist2D,
    Viewpoint,
)

ROBOT = RobotSpec(
    "scripted",
    Footprint(0.5, 0.38),
    BaseLimits(0.5, 0.2, 1.0, 0.5, 1.5),
    LidarSpec(181, math.pi, 0.05, 8.0, 10.0, Pose2D(0.15, 0.0), 0.3),
    PanTiltSpec(-2.6, 2.6, -0.8, 0.8, 1.5, 4.0),
    CameraSpec(CameraIntrinsics.from_fov(160, 120, 1.2), 0.1, 1.1, 0.3, 5.0, 5.0),
)
TOUR = np.array(
    [
        [1.2, 1.0],
        [1.6, 2.6],
        [3.2, 2.9],
        [4.6, 2.4],
        [5.2, 1.2],
        [5.6, 2.6],
        [6.2, 3.2],
        [6.2, 4.2],
        [7.3, 4.6],
        [6.2, 5.2],
    ]
)
WALLS = [(4, 7, 4, 176), (133, 136, 4, 176), (4, 136, 4, 7), (4, 136, 173, 176), (4, 40, 88, 91), (58, 136, 88, 91)]
DOORWAY = [(74, 77, 88, 118), (74, 77, 138, 176)]
FURNITURE = [(100, 128, 12, 44), (14, 34, 56, 84), (84, 96, 60, 86), (12, 40, 128, 170), (108, 130, 100, 120)]
MACHINE = [(112, 130, 150, 172)]


def apartment(explored: float = 1.0, version: int = 0) -> GridMap:
    """Return rooms of 8.6 m x 6.6 m, known up to a share of their width."""
    states = np.full((140, 180), UNKNOWN, dtype=np.int8)
    states[4:136, 4:176] = FREE
    for row0, row1, col0, col1 in WALLS + DOORWAY + FURNITURE + MACHINE:
        states[row0:row1, col0:col1] = OCCUPIED
    states[:, int(180 * explored) :] = UNKNOWN
    states.setflags(write=False)
    return GridMap(states, 0.05, (-0.2, -0.2), version)


LANDMARKS = (
    Landmark(0, (("bed", 0.93), ("sofa", 0.07)), (1.2, 5.5, 0.4), 0.8, 5),
    Landmark(1, (("sofa", 0.6), ("bed", 0.25), ("armchair", 0.15)), (3.3, 1.0, 0.4), 0.7, 3),
    Landmark(2, (("shelf", 0.5), ("desk", 0.5)), (3.4, 4.3, 0.8), 0.6, 2),
    Landmark(3, (("dining table", 0.99), ("desk", 0.01)), (7.2, 1.1, 0.7), 0.9, 4),
    Landmark(4, (("counter", 0.4), ("shelf", 0.35), ("desk", 0.25)), (5.3, 5.7, 0.9), 0.5, 2),
    Landmark(5, (("washing machine", 0.9), ("oven", 0.1)), (7.9, 5.9, 0.5), 0.5, 2),
)


def viewpoint(landmark: Landmark, bearing: float, distance: float) -> Viewpoint:
    x, y, _ = landmark.position
    away = landmark.radius + distance
    pose = Pose2D(x + away * math.cos(bearing), y + away * math.sin(bearing), bearing + math.pi)
    return Viewpoint(pose, landmark.position, landmark.radius, landmark.id, landmark.label)


VIEWPOINTS = (
    viewpoint(LANDMARKS[1], 1.8, 0.8),
    viewpoint(LANDMARKS[2], -2.2, 0.6),
    viewpoint(LANDMARKS[3], 2.4, 0.7),
    viewpoint(LANDMARKS[5], -1.9, 0.5),
)


def candidate(x: float, y: float, score: float, target: str = "alarm clock") -> Candidate:
    def pixels() -> tuple[np.ndarray, np.ndarray]:
        rgb = np.full((120, 160, 3), 200, dtype=np.uint8)
        rgb[60:] = 120
        rgb[50:70, 70:90] = (220, 40, 40)
        return rgb, np.full((120, 160), 2.0, dtype=np.float32)

    frame = RgbdFrame(ROBOT.camera.intrinsics, np.eye(4), 12.5, pixels)
    return Candidate(target, score, Box(70.0, 50.0, 90.0, 70.0), (x, y, 0.8), frame)


CANDIDATES = (candidate(3.0, 1.3, 29.8), candidate(6.7, 1.5, 30.4), candidate(6.1, 5.8, 33.1))
NODES = tuple(
    NodeState(*row)
    for row in (
        ("mission", "mission", "sequence", 0, NodeStatus.RUNNING, ""),
        ("mission/safe", "safe", "check", 1, NodeStatus.SUCCESS, ""),
        ("mission/search", "search", "selector", 1, NodeStatus.RUNNING, ""),
        ("mission/search/known", "look at landmarks", "sequence", 2, NodeStatus.RUNNING, ""),
        ("mission/search/known/scan", "scan", "scan", 3, NodeStatus.SUCCESS, "8 frames, 6 landmarks"),
        ("mission/search/known/order", "waypoints", "waypoints", 3, NodeStatus.SUCCESS, "4 viewpoints"),
        ("mission/search/known/go", "navigate", "navigate", 3, NodeStatus.RUNNING, "1.8 m to go"),
        ("mission/search/known/look", "look", "look", 3, NodeStatus.INVALID, ""),
        ("mission/search/known/confirm", "confirm", "confirm", 3, NodeStatus.FAILURE, "none of 2 is the target"),
        ("mission/search/frontier", "explore", "frontier", 2, NodeStatus.INVALID, ""),
    )
)


def drive(count: int) -> FloatArray:
    """Return (count, 2) points along the tour."""
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(TOUR, axis=0).T))))
    where = np.linspace(0, lengths[-1], count)
    return np.column_stack([np.interp(where, lengths, TOUR[:, axis]) for axis in range(2)])


@dataclass
class ScriptedMission:
    """An `Observed`; ``go`` moves it to a share of its way."""

    stamp: float = 0.0
    robot: RobotSpec = ROBOT
    base: BaseState = field(default_factory=lambda: BaseState(Pose2D(*TOUR[0], 0.6), Twist2D(), 0.0, 0.87))
    pan_tilt: PanTiltState = field(default_factory=lambda: PanTiltState(0.0, 0.0, True, 0.0))
    scan: LaserScan | None = None
    grid: GridMap = field(default_factory=apartment)
    landmarks: tuple[Landmark, ...] = ()
    nodes: tuple[NodeState, ...] = NODES
    path: Path | None = None
    viewpoints: tuple[Viewpoint, ...] = VIEWPOINTS
    visited: tuple[Viewpoint, ...] = ()
    candidates: tuple[Candidate, ...] = ()
    found: Candidate | None = None
    trajectory: FloatArray = field(default_factory=lambda: np.empty((0, 2)))

    def go(self, share: float) -> None:
        """Move everything to where it is at a share of the way, 0 to 1."""
        route = drive(400)
        now = int(share * 399)
        here, ahead = route[now], route[min(now + 1, 399)] - route[max(now - 1, 0)]
        pose = Pose2D(here[0], here[1], math.atan2(ahead[1], ahead[0]))
        self.stamp = 120.0 * share
        self.base = BaseState(pose, Twist2D(0.4, 0.1), self.stamp, 0.87 - 0.1 * share)
        self.pan_tilt = PanTiltState(0.8 * math.sin(20 * share), -0.2, False, self.stamp)
        explored = round(0.45 + 0.55 * min(1.0, share * 1.4), 2)
        if round(explored * 100) != self.grid.version:
            self.grid = apartment(explored, round(explored * 100))
        self.scan = scan_of(apartment(), pose @ ROBOT.lidar.mount, self.stamp)
        self.trajectory = route[: now + 1]
        self.path = Path(route[now : min(now + 80, 400)])
        self.landmarks = LANDMARKS[: 2 + int(4 * share)]
        seen = int(3.99 * share)
        self.visited, self.viewpoints = VIEWPOINTS[:seen], VIEWPOINTS[seen:]
        self.candidates = CANDIDATES[: int(3.99 * share)]
        running = 4 + int(100 * share) % 5
        self.nodes = tuple(
            replace(node, status=NodeStatus.RUNNING, reason=f"{100 * share:.0f} %") if i == running else node
            for i, node in enumerate(NODES)
        )


def scan_of(grid: GridMap, sensor: Pose2D, stamp: float) -> LaserScan:
    """Return what the LiDAR measures in the grid, by small steps."""
    spec = ROBOT.lidar
    angles = spec.angle_min + spec.angle_increment * np.arange(spec.beams) + sensor.yaw
    steps = np.arange(spec.range_min, spec.range_max, 0.04)
    points = np.stack((sensor.x + np.cos(angles)[:, None] * steps, sensor.y + np.sin(angles)[:, None] * steps), axis=-1)
    cells = grid.to_cells(points.reshape(-1, 2)).reshape(*points.shape)
    rows, cols = np.clip(cells[..., 0], 0, 139), np.clip(cells[..., 1], 0, 179)
    hit = grid.states[rows, cols] == OCCUPIED
    ranges = np.where(hit.any(axis=1), steps[hit.argmax(axis=1)], np.inf)
    return LaserScan(ranges, spec.angle_min, spec.angle_increment, spec.range_min, spec.range_max, stamp)


def finished() -> ScriptedMission:
    mission = ScriptedMission()
    mission.go(1.0)
    mission.visited, mission.viewpoints = VIEWPOINTS, ()
    mission.candidates, mission.found = CANDIDATES, CANDIDATES[2]
    return mission


RESULT = MissionResult("scripted-1", "zavis", True, "found", 0.61, 14.2, 8.7, 4, 3, 2, 120.0, 3.4, 7, {"scans": 5})
