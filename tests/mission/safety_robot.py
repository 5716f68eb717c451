"""A scripted robot for the safety layer: it notes what is sent to it, and says what a test wants."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from zavis_bt.errors import DeviceError
from zavis_bt.mission import MissionJournal, SafeRobot, SafetySettings
from zavis_bt.types import (
    BaseLimits,
    BaseState,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    LaserScan,
    LidarSpec,
    PanTiltSpec,
    PanTiltState,
    Pose2D,
    RgbdFrame,
    RobotSpec,
    Twist2D,
)

TICK = 0.1
BEAMS = 720
DISC = Footprint(0.36, 0.36, disc=True)
RECTANGLE = Footprint(0.6, 0.4, 0.05)
REST = Twist2D(0.0, 0.0)
Segment = tuple[float, float, float, float]
"""x0, y0, x1, y1 of a wall in the map [m]."""


def spec(footprint: Footprint = DISC, field_of_view: float = math.tau) -> RobotSpec:
    return RobotSpec(
        "scripted",
        footprint,
        BaseLimits(0.7, 0.4, 1.8, 0.8, 3.0),
        LidarSpec(BEAMS, field_of_view, 0.01, 10.0, 10.0, Pose2D(0.05, 0.0), 0.3),
        PanTiltSpec(-3.1, 3.1, -1.0, 1.0, 2.0, 8.0),
        CameraSpec(CameraIntrinsics.from_fov(64, 48, 1.0), 0.0, 0.9, 0.3, 5.0, 10.0),
    )


class Body:
    """A robot among walls. Time passes by `advance`; the base then ramps as its limits say, and stops hard at once."""

    def __init__(self, footprint: Footprint = DISC, walls: Sequence[Segment] = (), fov: float = math.tau) -> None:
        self.spec, self.walls, self.now = spec(footprint, fov), np.array(walls, dtype=float).reshape(-1, 4), 0.0
        self.pose, self.twist, self.told = Pose2D(0.0, 0.0), REST, REST
        self.sent: list[Twist2D | str] = []
        self.moves: list[tuple[float, float] | str] = []
        self.says: dict[str, object] = {}
        """Replaces fields of the base's state."""
        self.joints = PanTiltState(0.0, 0.0, True, 0.0)
        self.silent: set[str] = set()
        """Devices whose stamps stand still."""
        self.broken: set[str] = set()
        """Devices that raise at commands."""
        self.stamps = dict.fromkeys(("base", "pan_tilt", "lidar", "camera"), 0.0)
        self.base, self.pan_tilt, self.lidar, self.camera = _Base(self), _PanTilt(self), _Lidar(self), _Camera(self)
        self.closed = 0

    def advance(self, seconds: float = TICK, step: float = 0.02) -> None:
        limits = self.spec.limits
        for _ in range(round(seconds / step)):
            v = _ramp(self.twist.linear, self.told.linear, limits.linear_acceleration * step)
            w = _ramp(self.twist.angular, self.told.angular, limits.angular_acceleration * step)
            turn, way = (self.twist.angular + w) / 2 * step, (self.twist.linear + v) / 2 * step
            half = Pose2D(0.0, 0.0, turn / 2)
            self.pose, self.twist = self.pose @ half @ Pose2D(way, 0.0) @ half, Twist2D(v, w)
        self.now += seconds
        self.hear()

    def hear(self) -> None:
        """Let all devices but the silent ones speak."""
        for device in self.stamps.keys() - self.silent:
            self.stamps[device] = self.now

    def close(self) -> None:
        self.closed += 1

    @property
    def deepest(self) -> float:
        """How deep the walls reach into the outline [m]; negative if they do not touch it."""
        return max((_depth(self.spec.footprint, self.pose, wall) for wall in self.walls), default=-math.inf)


class _Base:
    def __init__(self, body: Body) -> None:
        self.body = body

    def state(self) -> BaseState:
        body = self.body
        return replace(BaseState(body.pose, body.twist, body.stamps["base"]), **body.says)

    def pose_at(self, stamp: float) -> Pose2D:
        return self.body.pose

    def command(self, twist: Twist2D) -> None:
        if "base" in self.body.broken:
            raise DeviceError("base: /dev/ttyUSB0 is gone (plug it in)")
        self.body.sent.append(twist)
        self.body.told = twist

    def stop(self) -> None:
        self.body.sent.append("stop")
        self.body.told = self.body.twist = REST


class _PanTilt:
    def __init__(self, body: Body) -> None:
        self.body = body

    def state(self) -> PanTiltState:
        return replace(self.body.joints, stamp=self.body.stamps["pan_tilt"])

    def angles_at(self, stamp: float) -> tuple[float, float]:
        return self.body.joints.pan, self.body.joints.tilt

    def move_to(self, pan: float, tilt: float) -> None:
        if "pan_tilt" in self.body.broken:
            raise DeviceError("pan_tilt: node 2 does not answer (check its cable)")
        self.body.moves.append((pan, tilt))

    def stop(self) -> None:
        self.body.moves.append("stop")


class _Lidar:
    def __init__(self, body: Body) -> None:
        self.body = body
        self.works = True
        self._last: LaserScan | None = None

    def scan(self) -> LaserScan | None:
        stamp = self.body.stamps["lidar"]
        if not self.works:
            return None
        if self._last is None or self._last.stamp != stamp:
            lidar = self.body.spec.lidar
            ranges = _sweep(self.body.walls, self.body.pose @ lidar.mount, lidar)
            self._last = LaserScan(ranges, lidar.angle_min, lidar.angle_increment, 0.01, 10.0, stamp)
        return self._last


class _Camera:
    def __init__(self, body: Body) -> None:
        self.body = body
        self.works = True

    def frame(self) -> RgbdFrame | None:
        if not self.works:
            return None
        return RgbdFrame(self.body.spec.camera.intrinsics, np.eye(4), self.body.stamps["camera"], lambda: 1 / 0)


class Layer:
    """The safety layer around a body, driven tick by tick."""

    def __init__(self, body: Body, **settings: float) -> None:
        self.body = body
        self.journal = MissionJournal(BodyClock(body))
        self.reasons: list[str] = []
        self.journal.sinks.append(lambda event: self.reasons.append(event.data["reason"]))
        self.robot = SafeRobot(body, SafetySettings(**settings), self.journal)

    def tick(self, twist: Twist2D | None, seconds: float = TICK) -> list[Twist2D | str]:
        """Read, ask, flush, let time pass; return what was sent to the base in this tick."""
        before = len(self.body.sent)
        self.robot.base.read(self.body.now)
        if twist is not None:
            self.robot.base.command(twist)
        self.robot.base.flush(self.body.now)
        sent = self.body.sent[before:]
        if seconds:
            self.body.advance(seconds)
        return sent


class BodyClock:
    def __init__(self, body: Body) -> None:
        self.body = body

    def now(self) -> float:
        return self.body.now

    def wait_until(self, stamp: float) -> None:
        if stamp > self.body.now:
            self.body.advance(stamp - self.body.now)


def square(half: float) -> list[Segment]:
    """Walls of a square room about the origin."""
    corners = [(half, half), (-half, half), (-half, -half), (half, -half)]
    return [(*corners[i], *corners[(i + 1) % 4]) for i in range(4)]


def _ramp(value: float, target: float, change: float) -> float:
    return value + min(max(target - value, -change), change)


def _sweep(walls: np.ndarray, sensor: Pose2D, lidar: LidarSpec) -> np.ndarray:
    angles = sensor.yaw + lidar.angle_min + lidar.angle_increment * np.arange(lidar.beams)
    ranges = np.full(lidar.beams, np.inf)
    dx, dy = np.cos(angles), np.sin(angles)
    for x0, y0, x1, y1 in walls:
        ex, ey, px, py = x1 - x0, y1 - y0, x0 - sensor.x, y0 - sensor.y
        with np.errstate(divide="ignore", invalid="ignore"):
            cross = dx * ey - dy * ex
            along, across = (px * ey - py * ex) / cross, (px * dy - py * dx) / cross
        hit = (along > 0) & (across >= 0) & (across <= 1) & (along <= lidar.range_max)
        ranges = np.where(hit & (along < ranges), along, ranges)
    return ranges


def _depth(footprint: Footprint, pose: Pose2D, wall: np.ndarray) -> float:
    share = np.linspace(0.0, 1.0, 400)[:, None]
    points = wall[:2] + share * (wall[2:] - wall[:2]) - (pose.x, pose.y)
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    ahead, aside = points @ (cos, sin), points @ (-sin, cos)
    if footprint.disc:
        return float(footprint.length / 2 - np.hypot(ahead, aside).min())
    front, back = footprint.length / 2 + footprint.centre_x, footprint.length / 2 - footprint.centre_x
    inside = np.minimum(np.minimum(front - ahead, back + ahead), footprint.width / 2 - np.abs(aside))
    return float(inside.max())
