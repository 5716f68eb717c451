"""The last word on every motion: checked outside the tree, whatever a behaviour asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from zavis_bt.protocols import Camera, Journal, Lidar, PanTilt, Robot
from zavis_bt.types import BaseState, FloatArray, LaserScan, Pose2D, RobotSpec, Twist2D


@dataclass(frozen=True, slots=True)
class SafetySettings:
    """When motion is limited or refused."""

    scan_timeout: float = 0.5
    """Age of the latest scan beyond which the base stands still [s]."""
    margin: float = 0.03
    """Distance that stays free after braking [m]."""
    tolerance: float = 0.035
    """How far an obstacle may reach into the outline's sides [m]: half a map cell and the LiDAR's error, since
    passages count as passable by cell centres."""
    min_battery: float = 0.05
    """State of charge below which the base stands still, 0 to 1."""
    creep: float = 0.1
    """Reverse speed allowed with a pressed bumper or a stalled wheel [m/s]."""


def free_distance(points: FloatArray, twist: Twist2D, spec: RobotSpec, tolerance: float) -> float:
    """Return how far the outline can travel along the twist's arc before it meets a point.

    The outline is taken as the band its sides sweep, with straight ends.

    Args:
        points: (n, 2) obstacles in the base frame [m].
        twist: Direction and curvature of the motion.
        spec: Robot whose outline moves.
        tolerance: Depth to which points may lie inside the band [m].

    Returns:
        Arc length [m]; inf if no point is in the band, and for a turn on the spot.
    """
    if not len(points) or abs(twist.linear) < 1e-6:
        return math.inf
    forward = math.copysign(1.0, twist.linear)
    x, y = points[:, 0] * forward, points[:, 1]
    curvature = twist.angular / twist.linear  # of the path, seen along the direction of motion
    half_width = spec.footprint.width / 2 - tolerance
    reach = spec.footprint.length / 2 + forward * spec.footprint.centre_x
    if abs(curvature) < 1e-3:
        along, across = x, y
        front = np.sqrt(np.maximum(reach**2 - across**2, 0.0)) if spec.footprint.disc else np.full_like(x, reach)
    else:
        radius, side = abs(1 / curvature), math.copysign(1.0, curvature)
        from_centre = np.hypot(x, y - side * radius)
        across = from_centre - radius
        along = np.arctan2(x, radius - side * y) * radius
        front = _arc_front(from_centre, radius, reach) if spec.footprint.disc else np.full_like(x, reach)
    ahead = (np.abs(across) < half_width) & (along > 0.0)
    return max(float(np.min(along - front, where=ahead, initial=math.inf)), 0.0)


def _arc_front(from_centre: FloatArray, radius: float, reach: float) -> FloatArray:
    """Return how far ahead on its arc a disc touches points at these distances from the turning centre [m]."""
    cosine = (from_centre**2 + radius**2 - reach**2) / np.maximum(2 * from_centre * radius, 1e-9)
    return np.asarray(radius * np.arccos(np.clip(cosine, -1.0, 1.0)))


class SafeBase:
    """Takes the twist a behaviour asks for and passes on what is safe, once a tick.

    A tick in which nobody asks for motion stops the base: no command outlives the behaviour that gave it.
    """

    def __init__(self, robot: Robot, settings: SafetySettings, journal: Journal) -> None:
        self._robot, self._settings, self._journal = robot, settings, journal
        self._requested: Twist2D | None = None
        self._reason = ""
        self._moving = False
        self.latest: BaseState = robot.base.state()
        self.scan: LaserScan | None = None

    @property
    def reason(self) -> str:
        """Why the latest twist was limited; empty if it was passed on as it was."""
        return self._reason

    def read(self) -> None:
        """Read base and LiDAR: what everybody sees during this tick."""
        self.latest = self._robot.base.state()
        self.scan = self._robot.lidar.scan()

    def state(self) -> BaseState:
        """Return the state read at the start of the tick."""
        return self.latest

    def pose_at(self, stamp: float) -> Pose2D:
        """Return the odometry pose at a time within the last second [s]."""
        return self._robot.base.pose_at(stamp)

    def command(self, twist: Twist2D) -> None:
        """Ask for a velocity; it is sent at the end of the tick, limited to what is safe."""
        self._requested = twist

    def stop(self) -> None:
        """Take back what was asked for and stop the base at once."""
        self._requested = None
        self._robot.base.stop()
        self._moving = False

    def flush(self, now: float) -> None:
        """Send this tick's twist to the base."""
        if self._requested is None:
            if self._moving:
                self._robot.base.stop()
            self._moving = False
            return
        twist, reason = self._limit(self._requested, now)
        if reason and reason != self._reason:
            self._journal.record("safety", reason=reason)
        self._reason, self._requested, self._moving = reason, None, True
        self._robot.base.command(twist)

    def _limit(self, twist: Twist2D, now: float) -> tuple[Twist2D, str]:
        settings, state = self._settings, self.latest
        if state.estop:
            return Twist2D(), "emergency stop"
        if state.battery < settings.min_battery:
            return Twist2D(), f"battery at {state.battery:.0%}"
        if self.scan is None or now - self.scan.stamp > settings.scan_timeout:
            return Twist2D(), "no recent LiDAR scan"
        if state.bumper or state.stalled:
            return self._back_off(twist), "bumper" if state.bumper else "stall"
        speed = self._admissible_speed(twist)
        if speed < abs(twist.linear):
            return Twist2D(math.copysign(speed, twist.linear), twist.angular), "obstacle ahead"
        return twist, ""

    def _back_off(self, twist: Twist2D) -> Twist2D:
        return Twist2D(max(min(twist.linear, 0.0), -self._settings.creep), twist.angular)

    def _admissible_speed(self, twist: Twist2D) -> float:
        """Speed from which the base still halts before the nearest obstacle on its arc [m/s]."""
        assert self.scan is not None
        points = scan_points(self.scan, self._robot.spec.lidar.mount)
        distance = free_distance(points, twist, self._robot.spec, self._settings.tolerance) - self._settings.margin
        if distance == math.inf:
            return math.inf
        return math.sqrt(2 * self._robot.spec.limits.linear_acceleration * max(distance, 0.0))


def scan_points(scan: LaserScan, mount: Pose2D) -> FloatArray:
    """Return the (n, 2) end points of the beams that hit something, in the base frame [m]."""
    hit = np.isfinite(scan.ranges) & (scan.ranges >= scan.range_min)
    angles = scan.angles[hit] + mount.yaw
    ranges = scan.ranges[hit]
    return np.column_stack((mount.x + ranges * np.cos(angles), mount.y + ranges * np.sin(angles)))


class SafeRobot:
    """A robot as behaviours get it: the same devices, the base behind the safety layer."""

    def __init__(self, robot: Robot, settings: SafetySettings, journal: Journal) -> None:
        self._robot = robot
        self._base = SafeBase(robot, settings, journal)

    @property
    def spec(self) -> RobotSpec:
        """The robot's model."""
        return self._robot.spec

    @property
    def base(self) -> SafeBase:
        """The base behind the safety layer."""
        return self._base

    @property
    def pan_tilt(self) -> PanTilt:
        """The pan-tilt unit."""
        return self._robot.pan_tilt

    @property
    def lidar(self) -> Lidar:
        """The LiDAR."""
        return self._robot.lidar

    @property
    def camera(self) -> Camera:
        """The camera."""
        return self._robot.camera

    def halt(self) -> None:
        """Stop everything that moves."""
        self._base.stop()
        self._robot.pan_tilt.stop()

    def close(self) -> None:
        """Stop and release the devices."""
        self._robot.close()
