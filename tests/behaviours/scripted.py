"""A robot in a square room, played by a few lines of arithmetic, to drive behaviours tick by tick."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from zavis_bt.geometry import transform_camera_to_map
from zavis_bt.mapping import Mapper
from zavis_bt.mission import InlineJobs, MissionJournal
from zavis_bt.planning import Navigator
from zavis_bt.tree import Behaviour, Status
from zavis_bt.types import (
    Answer,
    BaseLimits,
    BaseState,
    Box,
    CameraIntrinsics,
    CameraSpec,
    Candidate,
    Footprint,
    LandmarkSighting,
    LaserScan,
    LidarSpec,
    PanTiltSpec,
    PanTiltState,
    Percept,
    Pose2D,
    RgbdFrame,
    RobotSpec,
    Twist2D,
    Viewpoint,
)

TICK = 0.1
ROOM = 3.0  # half the side of the room [m]

SPEC = RobotSpec(
    "scripted",
    Footprint(0.36, 0.36, disc=True),
    BaseLimits(0.6, 0.3, 1.8, 1.0, 4.0),
    LidarSpec(360, math.tau, 0.05, 10.0, 10.0, Pose2D(0, 0), 0.3),
    PanTiltSpec(-math.pi, math.pi, -1.0, 1.0, 2.0, 10.0),
    CameraSpec(CameraIntrinsics.from_fov(64, 48, math.radians(60)), 0.0, 0.9, 0.2, 6.0, 30.0),
)


class ScriptedRobot:
    """Base that obeys at once, pan-tilt that takes two ticks a move, LiDAR and camera in a square room."""

    def __init__(self, spec: RobotSpec = SPEC) -> None:
        self.spec = spec
        self.time = 0.0
        self.twist = Twist2D()
        self.base_state = BaseState(Pose2D(0.0, 0.0), Twist2D(), 0.0)
        self.angles, self.settle_at = (0.0, 0.0), 0.0
        self.moves: list[tuple[float, float]] = []
        self.held = False
        self.camera_works = True
        self.base, self.pan_tilt, self.lidar, self.camera = _Base(self), _PanTilt(self), _Lidar(self), _Camera(self)

    def step(self) -> None:
        """Let a tick's time pass."""
        twist = Twist2D() if self.held else self.twist
        pose = self.base_state.pose
        middle = Pose2D(pose.x, pose.y, pose.yaw + twist.angular * TICK / 2)
        moved = middle @ Pose2D(twist.linear * TICK, 0.0, twist.angular * TICK / 2)
        self.time += TICK
        self.base_state = replace(self.base_state, pose=moved, twist=twist, stamp=self.time)

    def now(self) -> float:
        return self.time

    def wait_until(self, stamp: float) -> None:
        while self.time < stamp:
            self.step()

    def close(self) -> None: ...


@dataclass
class _Base:
    robot: ScriptedRobot

    def state(self) -> BaseState:
        return self.robot.base_state

    def pose_at(self, stamp: float) -> Pose2D:
        return self.robot.base_state.pose

    def command(self, twist: Twist2D) -> None:
        self.robot.twist = twist

    def stop(self) -> None:
        self.robot.twist = Twist2D()


@dataclass
class _PanTilt:
    robot: ScriptedRobot
    stops: int = 0

    def state(self) -> PanTiltState:
        settled = self.robot.time >= self.robot.settle_at
        return PanTiltState(*self.robot.angles, settled, self.robot.time)

    def angles_at(self, stamp: float) -> tuple[float, float]:
        return self.robot.angles

    def move_to(self, pan: float, tilt: float) -> None:
        self.robot.moves.append((pan, tilt))
        self.robot.angles, self.robot.settle_at = (pan, tilt), self.robot.time + 2 * TICK

    def stop(self) -> None:
        self.stops += 1


@dataclass
class _Lidar:
    robot: ScriptedRobot

    def scan(self) -> LaserScan:
        pose, lidar = self.robot.base_state.pose, self.robot.spec.lidar
        angles = lidar.angle_min + lidar.angle_increment * np.arange(lidar.beams) + pose.yaw
        with np.errstate(divide="ignore"):
            to_x = np.where(np.cos(angles) > 0, ROOM - pose.x, -ROOM - pose.x) / np.cos(angles)
            to_y = np.where(np.sin(angles) > 0, ROOM - pose.y, -ROOM - pose.y) / np.sin(angles)
        ranges = np.minimum(np.abs(to_x), np.abs(to_y))
        return LaserScan(ranges, lidar.angle_min, lidar.angle_increment, 0.05, 10.0, self.robot.time)


@dataclass
class _Camera:
    robot: ScriptedRobot

    def frame(self) -> RgbdFrame | None:
        if not self.robot.camera_works:
            return None
        robot, intrinsics = self.robot, self.robot.spec.camera.intrinsics
        transform = transform_camera_to_map(robot.base_state.pose, *robot.angles, robot.spec.camera)
        return RgbdFrame(
            intrinsics,
            transform,
            robot.time,
            lambda: (np.zeros((48, 64, 3), np.uint8), np.ones((48, 64), np.float32)),
        )


class ScriptedPerceiver:
    """Sees what the script says, whenever a frame looks within 30° of where it is."""

    def __init__(self) -> None:
        self.frames: list[RgbdFrame] = []
        self.landmarks: dict[tuple[float, float], str] = {}
        self.targets: list[tuple[float, float, float]] = []

    def perceive(self, frame: RgbdFrame, target: str) -> Percept:
        self.frames.append(frame)
        sightings = tuple(
            LandmarkSighting(((label, 0.9), ("other", 0.1)), (*place, 0.7), 0.4, 0.9, frame.stamp)
            for place, label in self.landmarks.items()
            if self._ahead(frame, *place)
        )
        candidates = tuple(candidate(target, spot, frame) for spot in self.targets if self._ahead(frame, *spot[:2]))
        return Percept(sightings, candidates)

    @staticmethod
    def _ahead(frame: RgbdFrame, x: float, y: float) -> bool:
        axis = frame.transform_camera_to_map[:2, 2]
        to = np.array([x, y]) - frame.transform_camera_to_map[:2, 3]
        return bool(axis @ to > math.cos(math.radians(30)) * np.linalg.norm(axis) * np.linalg.norm(to))


def candidate(target: str = "cup", position: tuple[float, float, float] = (1.0, 0.0, 0.8), frame=None) -> Candidate:
    if frame is None:
        frame = _Camera(ScriptedRobot()).frame()
    return Candidate(target, 30.0, Box(5, 5, 20, 20), position, frame)


def viewpoint(x: float = 1.0, y: float = 0.0, landmark: int = 0) -> Viewpoint:
    return Viewpoint(Pose2D(x, y, 0.0), (x + 1.0, y, 0.7), 0.5, landmark, "desk")


class ScriptedHuman:
    """Answers from a list, after so many ticks."""

    def __init__(self, *answers: Answer, delay: float = 0.0) -> None:
        self.answers, self.delay, self.asked, self.withdrawn = list(answers), delay, [], 0
        self.clock: ScriptedRobot | None = None

    def ask(self, target: str, candidates: Any) -> Any:
        self.asked.append(list(candidates))
        human, answer = self, self.answers.pop(0)
        ready = (self.clock.time if self.clock else 0.0) + self.delay

        class Reply:
            def done(self) -> bool:
                return human.clock is None or human.clock.time >= ready

            def result(self) -> Answer:
                return answer

            def cancel(self) -> None:
                human.withdrawn += not self.done()

        return Reply()


class FixedPrior:
    """Probabilities by label."""

    def __init__(self, **by_label: float) -> None:
        self.by_label = by_label

    def probability(self, target: str, landmarks: Any) -> np.ndarray:
        return np.array([self.by_label.get(label, 0.5) for label in landmarks])


@dataclass
class Stage:
    """Everything a behaviour may ask for, and a hand that turns the clock."""

    robot: ScriptedRobot = field(default_factory=ScriptedRobot)
    perceiver: ScriptedPerceiver = field(default_factory=ScriptedPerceiver)
    human: ScriptedHuman = field(default_factory=ScriptedHuman)
    prior: FixedPrior = field(default_factory=FixedPrior)

    def __post_init__(self) -> None:
        self.mapper = Mapper(self.robot.spec)
        self.journal = MissionJournal(self.robot)
        self.navigator = Navigator(self.robot.spec, lambda: self.mapper.grid)
        self.human.clock = self.robot
        self.sense()

    def sense(self) -> None:
        self.mapper.update(self.robot.lidar.scan(), self.robot.base_state.pose)

    def setup(self, behaviour: Behaviour) -> Behaviour:
        offered = {
            "robot": self.robot,
            "clock": self.robot,
            "jobs": InlineJobs(self.robot, latency={}),
            "mapper": self.mapper,
            "navigator": self.navigator,
            "perceiver": self.perceiver,
            "prior": self.prior,
            "human": self.human,
            "journal": self.journal,
            "rng": np.random.default_rng(0),
        }
        wanted = type(behaviour).setup.__kwdefaults__ or {}
        names = type(behaviour).setup.__code__.co_varnames[1 : 1 + type(behaviour).setup.__code__.co_kwonlyargcount]
        behaviour.setup(**{name: offered[name] for name in names if name in offered or name not in wanted})
        return behaviour

    def tick(self, behaviour: Behaviour) -> Status:
        self.sense()
        behaviour.tick_once()
        self.robot.step()
        return behaviour.status

    def run(self, behaviour: Behaviour, seconds: float = 60.0) -> Status:
        for _ in range(round(seconds / TICK)):
            if self.tick(behaviour) is not Status.RUNNING:
                break
        return behaviour.status
