"""The base behind the safety layer."""

from __future__ import annotations

import math
from dataclasses import replace

from zavis_bt.errors import DeviceError
from zavis_bt.mission.safety.braking import BrakingRule, Verdict
from zavis_bt.mission.safety.contact import Contact
from zavis_bt.mission.safety.pace import Pace
from zavis_bt.mission.safety.settings import SafetySettings
from zavis_bt.mission.safety.timeouts import scan_timeout
from zavis_bt.protocols import Journal, Robot
from zavis_bt.types import BaseState, LaserScan, Pose2D, Twist2D

_REST = Twist2D()
_MOVING = 0.01  # [m/s], [rad/s]


class SafeBase:
    """Takes the twist a behaviour asks for and passes on what is safe, once a tick.

    A tick in which nobody asks for motion slows the base down: no command outlives the behaviour that gave it.
    Where there is danger the base is stopped as fast as it can. What the base raises is kept in ``trouble``.
    """

    def __init__(self, robot: Robot, settings: SafetySettings, journal: Journal, period: float = 0.1) -> None:
        """Take the robot; nothing is sent.

        Args:
            robot: Whose base, read and commanded, and whose LiDAR, read.
            settings: Limits.
            journal: Told ``safety`` with a reason whenever a twist begins to be limited for another one.
            period: Expected time from `flush` to `flush` [s].
        """
        self._robot, self._settings, self._journal = robot, settings, journal
        self._braking = BrakingRule(robot.spec, settings)
        self._contact = Contact(robot.spec.footprint, settings.creep)
        self._pace = Pace(period, settings.tick_limit)
        self._scan_timeout = scan_timeout(settings, robot.spec.lidar)
        self._requested: Twist2D | None = None
        self._sent: Twist2D = _REST
        self._held = False
        self._reason = ""
        self.trouble = ""
        """What the base raised at the latest command; empty if it took it."""
        self.latest: BaseState = robot.base.state()
        """Read at the start of the tick: what everybody sees during it."""
        self.scan: LaserScan | None = None
        """Read at the start of the tick."""

    @property
    def reason(self) -> str:
        """Why the latest twist was limited; empty if it was passed on as it was."""
        return self._reason

    def read(self, now: float) -> None:
        """Read base and LiDAR; what the base said a moment ago is carried on to now [s]."""
        state = self._robot.base.state()
        self.latest = state if now <= state.stamp else replace(state, pose=self._robot.base.pose_at(now))
        self.scan = self._robot.lidar.scan()

    def state(self) -> BaseState:
        """Return the state read at the start of the tick."""
        return self.latest

    def pose_at(self, stamp: float) -> Pose2D:
        """Return the odometry pose at a time within the last second [s]."""
        return self._robot.base.pose_at(stamp)

    def command(self, twist: Twist2D) -> None:
        """Ask for a velocity; it is sent at the end of the tick, limited to what is safe.

        Raises:
            ValueError: The velocity is not finite.
        """
        if not (math.isfinite(twist.linear) and math.isfinite(twist.angular)):
            raise ValueError(f"{twist} is not a velocity")
        self._requested = twist

    def stop(self) -> None:
        """Take back what was asked for and stop the base at once, as fast as it can."""
        self._requested = None
        self._stop()

    def hold(self) -> None:
        """Stop at once and send nothing until `resume`."""
        self._held = True
        self.stop()

    def resume(self) -> None:
        """Send again what is asked for."""
        self._held, self.trouble = False, ""

    def flush(self, now: float) -> None:
        """Send this tick's twist to the base.

        What was decided on at the start of the tick is checked against what base and LiDAR say now [s].
        """
        requested, self._requested = self._requested, None
        state = self._robot.base.state()
        if self._held:
            self._brake(state)
            return
        lasted = self._pace.note(now)
        verdict = self._danger(state, now)
        if verdict is None:
            if requested is None:
                self._slow_down(state)
                return
            verdict = self._judge(requested, state, now, lasted)
        self._tell(verdict.reason if requested is not None else "")
        if verdict.hard:
            self._brake(state)
        else:
            self._send(verdict.twist)

    # -- rules -----------------------------------------------------------------------------------------------------

    def _danger(self, state: BaseState, now: float) -> Verdict | None:
        """Reasons to stop as fast as possible, whatever is asked for."""
        scan = self._robot.lidar.scan()
        if state.estop:
            return Verdict(_REST, "emergency stop", hard=True)
        if state.fault:
            return Verdict(_REST, state.fault, hard=True)
        if now - state.stamp > self._settings.base_timeout:
            return Verdict(_REST, "the base is not heard of", hard=True)
        if scan is None or now - scan.stamp > self._scan_timeout:
            return Verdict(_REST, "no recent LiDAR scan", hard=True)
        self._seen = scan
        if self._contact.begins(state, self._sent):
            return Verdict(_REST, self._contact.reason, hard=True)
        return None

    def _judge(self, asked: Twist2D, state: BaseState, now: float, lasted: float) -> Verdict:
        if state.battery < self._settings.min_battery:
            return Verdict(_REST, f"battery at {state.battery:.0%}")
        if self._pace.late:
            return Verdict(_REST, f"a tick took {lasted:.1f} s")
        allowed, reason = asked, ""
        if self._contact.reason:
            allowed, reason = self._contact.back_off(asked), self._contact.reason
        elif self._pace.often_late:
            allowed, reason = self._slowly(asked), "ticks take too long"
        verdict = self._brakeable(allowed, state, now)
        return verdict if verdict.reason else Verdict(verdict.twist, reason)

    def _brakeable(self, asked: Twist2D, state: BaseState, now: float) -> Verdict:
        scan = self._seen
        seen_from = state.pose if scan.stamp == state.stamp else self._robot.base.pose_at(scan.stamp)
        points = self._braking.points(scan, seen_from, state)
        delay = max(now - state.stamp, 0.0)
        return self._braking.limit(asked, state, points, self._sent, delay, self._pace.reaction)

    def _slowly(self, twist: Twist2D) -> Twist2D:
        share = min(self._settings.creep / max(abs(twist.linear), 1e-9), 1.0)
        return Twist2D(share * twist.linear, share * twist.angular)

    # -- what is sent ----------------------------------------------------------------------------------------------

    def _tell(self, reason: str) -> None:
        if reason and reason != self._reason:
            self._journal.record("safety", reason=reason)
        self._reason = reason

    def _slow_down(self, state: BaseState) -> None:
        """Nobody asks for motion: slow down within the limits, and say so until it stands."""
        if self._sent != _REST or _moves(state):
            self._send(_REST)

    def _brake(self, state: BaseState) -> None:
        """Stop once, and again while the base still moves."""
        if self._sent != _REST or _moves(state):
            self._stop()

    def _stop(self) -> None:
        self._sent = _REST
        self._pace.rest()
        self._robot.base.stop()

    def _send(self, twist: Twist2D) -> None:
        self._sent = twist
        try:
            self._robot.base.command(twist)
        except DeviceError as error:
            self.trouble = str(error)
            self._stop()
        else:
            self.trouble = ""


def _moves(state: BaseState) -> bool:
    return abs(state.twist.linear) > _MOVING or abs(state.twist.angular) > _MOVING
