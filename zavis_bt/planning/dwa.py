"""Local planner: the dynamic window approach (D. Fox, W. Burgard, S. Thrun, 1997) on a distance field."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from zavis_bt.planning.costmap import Costmap
from zavis_bt.planning.dwa_kernels import Rollout, best_motion, motion_fits
from zavis_bt.planning.grid_kernels import Body, body_fits, largest_fit
from zavis_bt.planning.scan_obstacles import deepest, unmapped
from zavis_bt.types import FloatArray, LaserScan, Pose2D, RobotSpec, Twist2D

_CORNER = 0.003  # margin for the corners of a rectangle where there is no room for more [m]
_BRAKING = 0.7  # share of the deceleration that is planned with to halt at a heading
_PREFERENCE = 0.01  # a motion with less margin must be better by this [m]
_SKIN = 0.01  # depth by which scan points may get deeper than they are [cells]
NO_OBSTACLES: FloatArray = np.empty((0, 2))


@dataclass(frozen=True, slots=True)
class DwaSettings:
    """How motions are chosen."""

    speeds: int = 9
    """Speeds tried."""
    rates: int = 31
    """Turn rates tried; odd, so that the present one is among them."""
    horizon: float = 1.3
    """How far ahead motions are judged [s]."""
    margin: float = 0.015
    """Clearance kept around the outline where there is room for it [m]."""
    give: float = 0.035
    """How far scan points may reach into the outline [m]: half a cell and the LiDAR's error, as obstacles count by
    their cells' centres."""
    heading_weight: float = 0.12
    """[m/rad]"""
    path_weight: float = 0.6
    clearance_weight: float = 0.1
    """[m]"""
    comfort: float = 0.2
    """Clearance beyond the outline from which more is not better [m]."""
    smoothness: float = 0.01
    """[m per rad/s]"""
    worthwhile: float = 0.4
    """A motion that keeps the margin is taken at once if it is better than to stand still by this share of the way
    that the base could go within the horizon."""


class DwaPlanner:
    """Chooses the twist for the next moment: among those the base can reach, the best that can still be braked.

    The outline is checked with a margin first. Where that leaves no motion (passages can be exactly as wide as the
    robot) it is checked as it is, and where the robot overlaps an obstacle already, as much smaller as it takes.
    """

    def __init__(self, spec: RobotSpec, settings: DwaSettings | None = None) -> None:
        """Describe the robot.

        Args:
            spec: Outline, limits and the LiDAR's mount.
            settings: How motions are chosen; None for the default.
        """
        self._spec, self._settings = spec, settings or DwaSettings()

    def obstacles(self, pose: Pose2D, scan: LaserScan, costmap: Costmap) -> FloatArray:
        """Return the (n, 2) scan points near the robot that are not on the map [m].

        Args:
            pose: The robot at the time of the scan.
            scan: Latest scan.
            costmap: What is mapped.
        """
        resolution = costmap.grid.resolution
        limits = self._spec.limits
        reach = limits.max_linear * self._settings.horizon + costmap.turning_radius + self._spec.lidar.mount.x
        points = unmapped(
            costmap.field,
            costmap.body,
            _uv(costmap, pose),
            _uv(costmap, pose @ self._spec.lidar.mount),
            scan.ranges / resolution,
            scan.angle_min,
            scan.angle_increment,
            scan.range_min / resolution,
            reach / resolution,
        )
        return costmap.to_points(points)

    def command(
        self,
        pose: Pose2D,
        twist: Twist2D,
        target: tuple[float, float],
        costmap: Costmap,
        dt: float,
        *,
        path: FloatArray = NO_OBSTACLES,
        speed_limit: float = math.inf,
        obstacles: FloatArray = NO_OBSTACLES,
    ) -> Twist2D | None:
        """Return the twist for the next ``dt`` seconds.

        Args:
            pose: The robot.
            twist: Its velocity.
            target: Where to go next, in a straight line [m].
            costmap: What is mapped.
            dt: Time to the next command [s].
            path: (n, 2) the path around here [m]; motions that leave it are worse.
            speed_limit: [m/s]
            obstacles: (n, 2) further obstacles, not mapped [m].

        Returns:
            None if no motion is admissible.
        """
        resolution = costmap.grid.resolution
        speeds, rates = self._window(twist, dt, speed_limit)
        state = _uv(costmap, pose)
        (goal,) = costmap.to_uv(np.array([target]))
        found, most = None, -math.inf
        points = costmap.to_uv(obstacles)
        give = self._give(costmap, state, points)
        for body, stride in zip(self._outlines(costmap, state), (1.0, 0.3), strict=False):
            i, j, gain = best_motion(
                costmap.field,
                body,
                self._rollout(dt, resolution, stride),
                state,
                speeds / resolution,
                rates,
                (twist.linear / resolution, twist.angular),
                (goal[0], goal[1]),
                costmap.to_uv(path),
                points,
                give,
            )
            if i >= 0 and gain * resolution > most:
                found, most = Twist2D(float(speeds[i]), float(rates[j])), gain * resolution + _PREFERENCE
            if most > self._settings.worthwhile * speeds[-1] * self._settings.horizon:
                break
        return found

    def turn(
        self,
        pose: Pose2D,
        twist: Twist2D,
        heading: float,
        costmap: Costmap,
        dt: float,
        obstacles: FloatArray = NO_OBSTACLES,
    ) -> Twist2D | None:
        """Return the twist that turns towards a heading on the spot, braking first if need be.

        Args:
            pose: The robot.
            twist: Its velocity.
            heading: Wanted yaw [rad].
            costmap: What is mapped.
            dt: Time to the next command [s].
            obstacles: (n, 2) further obstacles, not mapped [m].

        Returns:
            None if the outline cannot turn here.
        """
        error = math.remainder(heading - pose.yaw, math.tau)
        change = self._spec.limits.linear_acceleration * dt
        speed = math.copysign(max(abs(twist.linear) - change, 0.0), twist.linear)
        state, resolution = _uv(costmap, pose), costmap.grid.resolution
        points = costmap.to_uv(obstacles)
        give = self._give(costmap, state, points)
        for body in self._outlines(costmap, state):
            for angle in (error, error - math.copysign(math.tau, error)):  # the long way where the short one is barred
                if not motion_fits(costmap.field, body, state, 0.0, angle, 1.0, points, give):
                    continue
                rate = self._turn_rate(angle, twist.angular, dt)
                if speed == 0.0 or motion_fits(
                    costmap.field, body, state, speed / resolution, rate, 3 * dt, points, give
                ):
                    return Twist2D(speed, rate)
        return Twist2D() if abs(twist.linear) > 1e-3 else None

    def _turn_rate(self, error: float, now: float, dt: float) -> float:
        """Turn rate from which the base, commanded once more, still halts at the heading; reachable by now [rad/s]."""
        limits = self._spec.limits
        slowing = _BRAKING * limits.angular_acceleration
        halting = slowing * (math.sqrt(dt * dt + 2 * abs(error) / slowing) - dt)
        rate = math.copysign(min(halting, limits.max_angular, abs(error) / (2 * dt)), error)
        change = limits.angular_acceleration * dt
        return min(max(rate, now - change), now + change)

    def _window(self, twist: Twist2D, dt: float, speed_limit: float) -> tuple[FloatArray, FloatArray]:
        """Speeds and turn rates that the base can reach within ``dt``."""
        limits, settings = self._spec.limits, self._settings
        change = limits.linear_acceleration * dt
        top = min(limits.max_linear, max(speed_limit, 0.0))
        high = min(max(twist.linear + change, 0.0), max(top, twist.linear - change, 0.0))
        low = min(max(twist.linear - change, 0.0), high)
        turn = limits.angular_acceleration * dt
        rates = np.linspace(twist.angular - turn, twist.angular + turn, settings.rates)
        return np.linspace(low, high, settings.speeds), rates.clip(-limits.max_angular, limits.max_angular)

    def _rollout(self, dt: float, resolution: float, stride: float) -> Rollout:
        settings = self._settings
        return Rollout(
            settings.horizon,
            0.1,
            stride,
            0.9 * self._spec.limits.linear_acceleration / resolution,
            0.9 * self._spec.limits.angular_acceleration,
            dt,
            settings.heading_weight / resolution,
            settings.path_weight,
            settings.clearance_weight / resolution,
            settings.comfort / resolution,
            settings.smoothness / resolution,
        )

    def _give(self, costmap: Costmap, state: tuple[float, float, float], points: FloatArray) -> float:
        """How deep scan points may reach into the outline [cells]: no deeper than they do already, if they do."""
        return max(self._settings.give / costmap.grid.resolution, float(deepest(costmap.body, state, points)) + _SKIN)

    def _outlines(self, costmap: Costmap, state: tuple[float, float, float]) -> tuple[Body, ...]:
        """The outlines to try: with the margin, as it is or nearly, or shrunk to what is free now."""
        body, resolution = costmap.body, costmap.grid.resolution
        scale = largest_fit(costmap.field, body, *state)
        if scale < 1.0:
            return (body.scaled(scale - 1e-3),)
        if not body.disc:  # corners pass obstacles between the poses that are checked
            cautious = body.padded(_CORNER / resolution)
            body = cautious if body_fits(costmap.field, cautious, *state) else body
        return body.padded(self._settings.margin / resolution), body


def _uv(costmap: Costmap, pose: Pose2D) -> tuple[float, float, float]:
    (x0, y0), resolution = costmap.grid.origin, costmap.grid.resolution
    return (pose.x - x0) / resolution - 0.5, (pose.y - y0) / resolution - 0.5, pose.yaw
