"""Following a path, one command at a time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum, auto

from zavis_bt.planning.costmap import Costmaps
from zavis_bt.planning.dwa import NO_OBSTACLES, DwaPlanner
from zavis_bt.planning.guide import Aim, Guide
from zavis_bt.planning.shaping import TwistShaper
from zavis_bt.planning.stall import StallWatch
from zavis_bt.planning.track import Track
from zavis_bt.types import BaseState, FloatArray, LaserScan, Path, Pose2D, RobotSpec, Twist2D

_PERIOD = 0.1  # time to the next command while it is not known yet [s]
_MAP_PERIOD = 0.5  # the path is compared with a new map at most so often [s]; the scan is looked at every time
_LOST = 0.6  # so far off the path it is no longer the path [m]
_PATIENCE = 0.5  # without an admissible motion for so long is blocked [s]
_TURN = math.radians(60), math.radians(12)  # turn on the spot from one bearing to the target down to the other
_TURN_EXACTLY = math.radians(4), math.radians(1)  # the same where the passage is narrow
_SETTLED = 0.06  # turning slower than this the base may drive into a narrow passage [rad/s]
_PATH_AHEAD = 1.1  # so much of the path counts for how far motions are off it [m]
_LAG = 0.3  # a base that gets to the commanded velocity within this time follows it [s]
_PAUSE = 1.0  # without an update for so long the robot was held, and has not stood still by itself [s]
_IDLE = 0.02  # motions slower than this lead nowhere [m/s], [rad/s]
_AT_END = 0.03  # the end of the path counts as reached from here [m]


class FollowStatus(Enum):
    """How following a path goes."""

    DRIVING = auto()
    TURNING = auto()
    """At the goal, turning to its heading."""
    ARRIVED = auto()
    INVALID = auto()
    """New map has made the rest of the path impassable, or the robot is far off it: plan anew."""
    BLOCKED = auto()
    """No motion is admissible."""
    STUCK = auto()
    """The robot does not move, or moves without coming nearer."""


@dataclass(frozen=True, slots=True)
class Progress:
    """One step of following a path."""

    twist: Twist2D
    """What to command now; zero unless driving or turning."""
    status: FollowStatus
    remaining: float
    """Path still to go [m]."""
    driven: float
    """Distance driven on this path [m]."""


class PathFollower:
    """Drives along a path: a point of it that the robot can see is the local planner's target."""

    def __init__(
        self,
        spec: RobotSpec,
        costmaps: Costmaps,
        path: Path,
        goal: Pose2D,
        *,
        tolerance: float = 0.1,
        yaw_tolerance: float | None = None,
        shaper: TwistShaper | None = None,
    ) -> None:
        """Take the path.

        Args:
            spec: Robot that drives.
            costmaps: Source of the current costmap.
            path: From about where the robot is to the goal.
            goal: Where to stand.
            tolerance: Accepted distance [m].
            yaw_tolerance: Accepted heading error [rad]; None if the heading does not matter.
            shaper: Makes the commands smooth; None to command what the local planner chose.
        """
        self._shaper = shaper
        self._limits, self._costmaps, self._goal = spec.limits, costmaps, goal
        self._tolerance, self._yaw_tolerance = tolerance, yaw_tolerance
        self._track, self._dwa, self._watch = Track(path), DwaPlanner(spec), StallWatch()
        self._guide = Guide(spec, self._track)
        self._costmap, self._checked_at = costmaps.current, -math.inf
        self._guide.use(self._costmap)
        # A start where the robot does not fit is left on the first line of the path.
        self._escape = 0.0 if self._costmap.path_fits(self._track.points[:2]) else float(self._track.arc[1])
        self._last: BaseState | None = None
        self._command = Twist2D()
        self._shaped: Twist2D | None = None
        self._turning = self._at_goal = False
        self._blocked_since: float | None = None
        self._driven = 0.0

    @property
    def driven(self) -> float:
        """Distance driven on this path [m]."""
        return self._driven

    def update(self, state: BaseState, scan: LaserScan | None) -> Progress:
        """Return what to command now. Call it at a steady rate with fresh values.

        Args:
            state: The base.
            scan: Latest scan, for obstacles that are not on the map; None to trust the map.
        """
        dt = self._note(state)
        off = self._track.advance(state.pose.x, state.pose.y)
        if self._arrived(state.pose):
            return self._turn_to_goal(state, scan, dt)
        if off > _LOST or not self._still_fits(state.stamp):
            return self._end(FollowStatus.INVALID)
        aim = self._guide.aim(state.pose)
        bearing = state.pose.bearing(*aim.target)
        if self._watch.stuck(state.stamp, state.pose, self._command, self._track.remaining, bearing):
            return self._end(FollowStatus.STUCK)
        return self._go(FollowStatus.DRIVING, self._drive(state, scan, dt, aim, bearing), state, dt)

    def _note(self, state: BaseState) -> float:
        """Sum up the way driven; return the time from command to command [s]."""
        last, self._last = self._last, state
        if last is None:
            return _PERIOD
        self._driven += state.pose.distance(last.pose)
        if state.stamp - last.stamp > _PAUSE:
            self._watch, self._blocked_since, self._command = StallWatch(), None, Twist2D()
        return min(max(state.stamp - last.stamp, 0.02), 0.3)

    def _arrived(self, pose: Pose2D) -> bool:
        """Whether the goal's position is or has been reached, beside it but not on the other side of a wall."""
        near = pose.distance(self._goal) <= self._tolerance and self._track.remaining <= 2 * self._tolerance + _AT_END
        self._at_goal = self._at_goal or near or self._track.remaining <= _AT_END
        return self._at_goal

    def _turn_to_goal(self, state: BaseState, scan: LaserScan | None, dt: float) -> Progress:
        error = math.remainder(self._goal.yaw - state.pose.yaw, math.tau)
        if self._yaw_tolerance is None or abs(error) <= self._yaw_tolerance:
            return self._end(FollowStatus.ARRIVED)
        if self._watch.stuck(state.stamp, state.pose, self._command, 0.0, error):
            return self._end(FollowStatus.STUCK)
        obstacles = self._obstacles(state.pose, scan)
        twist = self._dwa.turn(state.pose, self._moving(state.twist), self._goal.yaw, self._costmap, dt, obstacles)
        return self._go(FollowStatus.TURNING, twist, state, dt)

    def _still_fits(self, stamp: float) -> bool:
        """Whether the rest of the path fits the current map; looked at when there is a new one."""
        if stamp - self._checked_at < _MAP_PERIOD or self._costmaps.version == self._costmap.grid.version:
            return True
        self._costmap, self._checked_at = self._costmaps.current, stamp
        self._guide.use(self._costmap)
        begin = max(self._track.position + self._costmap.radius, self._escape)
        rest = self._track.stretch(min(begin, self._track.length), self._track.length)
        return self._costmap.path_fits(rest)

    def _drive(self, state: BaseState, scan: LaserScan | None, dt: float, aim: Aim, bearing: float) -> Twist2D | None:
        pose, twist = state.pose, self._moving(state.twist)
        obstacles = self._obstacles(pose, scan)
        turn_from, turn_to = _TURN_EXACTLY if aim.exact else _TURN
        spinning = self._turning and aim.exact and abs(twist.angular) > _SETTLED
        self._turning = abs(bearing) > (turn_to if self._turning else turn_from) or spinning
        if self._turning:
            turn = self._dwa.turn(pose, twist, pose.yaw + bearing, self._costmap, dt, obstacles)
            if turn is not None:
                return turn
        position = self._track.position
        chosen = self._dwa.command(
            pose,
            twist,
            aim.target,
            self._costmap,
            dt,
            path=self._track.stretch(position, position + _PATH_AHEAD),
            speed_limit=aim.speed_limit,
            obstacles=obstacles,
        )
        idle = chosen is not None and abs(chosen.linear) < _IDLE and abs(chosen.angular) < _IDLE
        return None if idle else chosen

    def _moving(self, measured: Twist2D) -> Twist2D:
        """The velocity from which the next command starts: the last command, if the base follows it."""
        lag = Twist2D(self._command.linear - measured.linear, self._command.angular - measured.angular)
        follows = (
            abs(lag.linear) < _LAG * self._limits.linear_acceleration
            and abs(lag.angular) < _LAG * self._limits.angular_acceleration
        )
        return self._command if follows else measured

    def _obstacles(self, pose: Pose2D, scan: LaserScan | None) -> FloatArray:
        return NO_OBSTACLES if scan is None else self._dwa.obstacles(pose, scan, self._costmap)

    def _smooth(self, twist: Twist2D, measured: Twist2D, dt: float) -> Twist2D:
        """Shape a command on from the last one, or from what the base does if it does not follow."""
        if self._shaper is None:
            return twist
        if (moving := self._moving(measured)) is not self._shaped:
            self._shaper.reset(moving)
        self._shaped = self._shaper.shape(twist, dt)
        return self._shaped

    def _go(self, status: FollowStatus, twist: Twist2D | None, state: BaseState, dt: float) -> Progress:
        """Command the twist; without one stand still, and after a while say so."""
        if twist is not None:
            self._blocked_since, self._command = None, self._smooth(twist, state.twist, dt)
            return Progress(self._command, status, self._track.remaining, self._driven)
        if self._blocked_since is None:
            self._blocked_since = state.stamp
        if state.stamp - self._blocked_since >= _PATIENCE:
            return self._end(FollowStatus.BLOCKED)
        self._command = Twist2D()
        return Progress(self._command, status, self._track.remaining, self._driven)

    def _end(self, status: FollowStatus) -> Progress:
        self._command = Twist2D()
        return Progress(self._command, status, self._track.remaining, self._driven)
