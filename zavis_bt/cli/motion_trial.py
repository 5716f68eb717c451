"""Moving a robot a little, to see that it does as it is told."""

from __future__ import annotations

import math

from zavis_bt.mission import MissionJournal, SafeRobot, SafetySettings
from zavis_bt.protocols import Clock, PanTilt, Robot
from zavis_bt.types import BaseState, PanTiltSpec, Twist2D, wrap_angle

WAY, TURN, NOD = 0.1, math.radians(10), math.radians(10)
"""How far the base drives [m] and turns [rad], and the pan-tilt unit moves [rad]."""
_SPEED, _TURNING = 0.1, 0.3  # [m/s], [rad/s]
_PERIOD = 0.05  # [s]
_PATIENCE = 5.0  # so long a motion may take [s]
_HALT = 1.0  # so long the base may take to come to rest [s]
_SHARE = 0.5  # of a motion that must at least be seen


def try_pan_tilt(unit: PanTilt, limits: PanTiltSpec, clock: Clock) -> list[str]:
    """Pan and tilt by 10 degrees and back; return what is wrong."""
    state = unit.state()
    home = (state.pan, state.tilt)
    away = tuple(
        angle + (NOD if angle + NOD <= high else -NOD)
        for angle, high in zip(home, (limits.pan_max, limits.tilt_max), strict=True)
    )
    problems = []
    for target in (away, home):
        unit.move_to(*target)
        clock.wait_until(clock.now() + 2 * _PERIOD)  # so that the state speaks of this move
        if not _settles(unit, clock):
            problems.append(_not_there(unit, target))
            unit.stop()
            break
    return problems


def _settles(unit: PanTilt, clock: Clock) -> bool:
    end = clock.now() + _PATIENCE
    while clock.now() < end:
        if unit.state().settled:
            return True
        clock.wait_until(clock.now() + _PERIOD)
    return False


def _not_there(unit: PanTilt, target: tuple[float, ...]) -> str:
    state = unit.state()
    is_at, wanted = (
        "/".join(f"{math.degrees(angle):.0f}°" for angle in pair) for pair in ((state.pan, state.tilt), target)
    )
    return f"was sent to pan/tilt {wanted} and is at {is_at} after {_PATIENCE:g} s (is it blocked?)"


class BaseTrial:
    """Drives 10 cm ahead and back, turns 10 degrees and back, with the safety layer in between."""

    def __init__(self, robot: Robot, safety: SafetySettings, clock: Clock) -> None:
        journal = MissionJournal(clock)
        self._held_back: list[str] = []
        journal.sinks.append(lambda event: self._held_back.append(str(event.data.get("reason", event.kind))))
        self._base = SafeRobot(robot, safety, journal, _PERIOD).base
        self._clock = clock

    def run(self) -> list[str]:
        """Move; return what is wrong. The base stands afterwards, whatever happened."""
        try:
            return [
                *self._move("drive 10 cm ahead", Twist2D(_SPEED, 0.0), WAY),
                *self._move("drive 10 cm back", Twist2D(-_SPEED, 0.0), WAY),
                *self._move("turn 10° left", Twist2D(0.0, _TURNING), TURN),
                *self._move("turn 10° right", Twist2D(0.0, -_TURNING), TURN),
            ]
        finally:
            self._base.stop()

    def _move(self, what: str, twist: Twist2D, wanted: float) -> list[str]:
        self._base.read(self._clock.now())
        first = self._base.latest
        self._held_back.clear()
        end, done = self._clock.now() + _PATIENCE, 0.0
        while done < wanted and self._clock.now() < end:
            self._base.command(twist)
            self._base.flush(self._clock.now())
            self._clock.wait_until(self._clock.now() + _PERIOD)
            self._base.read(self._clock.now())
            done = _moved(first, self._base.latest, turning=twist.angular != 0)
        self._base.stop()
        self._rest()
        if done < _SHARE * wanted:
            if self._held_back:
                return [f"was told to {what} and was held back: {self._held_back[0]}"]
            share = done / wanted
            return [f"was told to {what} and did {share:.0%} of it (are the motors switched on, the wheels free?)"]
        return []

    def _rest(self) -> None:
        """Wait until the base stands."""
        end = self._clock.now() + _HALT
        while self._clock.now() < end:
            self._clock.wait_until(self._clock.now() + _PERIOD)
            twist = self._base.latest.twist
            self._base.read(self._clock.now())
            if twist == self._base.latest.twist == Twist2D():
                return


def _moved(first: BaseState, latest: BaseState, *, turning: bool) -> float:
    if turning:
        return abs(wrap_angle(latest.pose.yaw - first.pose.yaw))
    return first.pose.distance(latest.pose)
