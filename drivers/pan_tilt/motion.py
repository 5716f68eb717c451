"""How moves are made: by set-points every cycle, or by the drives' own profiles."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from enum import Enum, auto
from typing import Protocol

from drivers.pan_tilt.axis import Axis
from drivers.pan_tilt.objects import ACKNOWLEDGED, AT_ONCE, HALT, NEW_SET_POINT, TARGET_REACHED
from drivers.pan_tilt.states import ENABLE_OPERATION
from drivers.pan_tilt.trajectory import Trajectory
from drivers.pan_tilt.trouble import Trouble
from zavis_bt.types import PanTiltSpec

_HAND_SHAKE = 1.0  # [s]
_HEARD = 0.1  # time after which a halt shows in the measurements [s]
_AT_REST = 0.01  # [rad/s]

Command = tuple[int, int]
"""Controlword and target position of one drive."""
SetProfile = Callable[[Axis, float, float], None]
"""Gives a drive the rate [rad/s] and the acceleration [rad/s²] of its moves."""


class Motion(Protocol):
    """A way to make moves. All angles are pan and tilt [rad]; one thread uses it."""

    @property
    def done(self) -> bool:
        """Whether the drives have been told all of the last move, and say that they have made it if they do say."""

    @property
    def goal(self) -> tuple[float, float]:
        """Where the last move ends."""

    def hold(self) -> None:
        """Begin at the measured angles, at rest."""

    def go_to(self, angles: tuple[float, float]) -> None:
        """Begin a move."""

    def halt(self) -> None:
        """Come to rest as fast as the limits allow."""

    def step(self) -> list[Command]:
        """Return what the drives are told in this cycle, in the order of the axes."""


class CyclicMotion:
    """Set-points of a `Trajectory` every cycle."""

    def __init__(self, axes: Sequence[Axis], trajectory: Trajectory) -> None:
        self._axes, self._trajectory = axes, trajectory
        self._halting = False
        self.goal = trajectory.position
        """Where the last move ends [rad]."""

    @property
    def done(self) -> bool:
        """Whether the last set-point has been sent."""
        return self._trajectory.done

    def hold(self) -> None:
        """Begin at the measured angles, at rest."""
        pan, tilt = self._axes
        self.goal = pan.angle, tilt.angle
        self._trajectory.hold(self.goal)

    def go_to(self, angles: tuple[float, float]) -> None:
        """Begin a move."""
        self.goal, self._halting = angles, False
        self._trajectory.go_to(angles)

    def halt(self) -> None:
        """Come to rest as fast as the limits allow."""
        self._trajectory.halt()
        self._halting = True

    def step(self) -> list[Command]:
        """Return the next set-points.

        Raises:
            Trouble: There is no trajectory to the goal.
        """
        angles = self._trajectory.step()
        if self._halting and self._trajectory.done:
            self.goal, self._halting = angles, False
        return [(ENABLE_OPERATION, axis.to_units(angle)) for axis, angle in zip(self._axes, angles, strict=True)]


class _Phase(Enum):
    HALTING = auto()
    PREPARING = auto()  # the new set-point's bit is down until both drives have taken theirs back
    RAISED = auto()
    LOWERED = auto()
    GOING = auto()
    RESTING = auto()


class ProfileMotion:
    """Targets handed to the drives, whose profiles are scaled so that axes at rest start and arrive together."""

    def __init__(self, axes: Sequence[Axis], spec: PanTiltSpec, set_profile: SetProfile) -> None:
        self._axes, self._spec, self._set_profile = axes, spec, set_profile
        self._phase = _Phase.RESTING
        self._halt = 0
        self._since = 0.0
        self.goal = (0.0, 0.0)
        """Where the last move ends [rad]."""

    @property
    def done(self) -> bool:
        """Whether both drives say that they are at the target."""
        return self._phase is _Phase.RESTING

    def hold(self) -> None:
        """Begin at the measured angles, at rest."""
        self.goal = self._measured
        self._halt = 0
        self._enter(_Phase.RESTING)

    def go_to(self, angles: tuple[float, float]) -> None:
        """Begin a move.

        Raises:
            Trouble: A drive refuses its profile.
        """
        ways = [abs(angle - now) for angle, now in zip(angles, self._measured, strict=True)]
        longest = max(*ways, 1e-9)
        for axis, way in zip(self._axes, ways, strict=True):
            share = max(way / longest, 0.01)
            self._set_profile(axis, self._spec.max_rate * share, self._spec.max_acceleration * share)
        self.goal = angles
        self._enter(_Phase.PREPARING)

    def halt(self) -> None:
        """Come to rest as fast as the drives' profiles allow."""
        if self._phase is not _Phase.RESTING:
            self._halt = HALT
            self._enter(_Phase.HALTING)

    def step(self) -> list[Command]:
        """Return the words of the hand-shake, and the targets.

        Raises:
            Trouble: A drive does not take part in it.
        """
        self._advance()
        word = ENABLE_OPERATION | AT_ONCE | self._halt
        if self._phase is _Phase.RAISED:
            word |= NEW_SET_POINT
        return [(word, axis.to_units(angle)) for axis, angle in zip(self._axes, self.goal, strict=True)]

    @property
    def _measured(self) -> tuple[float, float]:
        pan, tilt = self._axes
        return pan.angle, tilt.angle

    def _advance(self) -> None:
        waited = time.monotonic() - self._since
        at_rest = all(abs(axis.velocity / axis.units) < _AT_REST for axis in self._axes)
        if self._phase is _Phase.HALTING and at_rest and waited > _HEARD:
            # A drive goes on to its old target when the halt ends, unless it is given the place where it stands.
            self.goal = self._measured
            self._enter(_Phase.PREPARING)
        elif self._phase is _Phase.PREPARING and not self._any(ACKNOWLEDGED):
            self._halt = 0
            self._enter(_Phase.RAISED)
        elif self._phase is _Phase.RAISED and self._all(ACKNOWLEDGED):
            self._enter(_Phase.LOWERED)
        elif self._phase is _Phase.LOWERED and not self._any(ACKNOWLEDGED):
            self._enter(_Phase.GOING)
        elif self._phase is _Phase.GOING and self._all(TARGET_REACHED):
            self._enter(_Phase.RESTING)
        elif self._phase in _WAITING and waited > _HAND_SHAKE:
            raise Trouble("a drive does not take set-points (is it in profile position mode?)")

    def _enter(self, phase: _Phase) -> None:
        self._phase, self._since = phase, time.monotonic()

    def _any(self, bit: int) -> bool:
        return any(axis.statusword & bit for axis in self._axes)

    def _all(self, bit: int) -> bool:
        return all(axis.statusword & bit for axis in self._axes)


_WAITING = (_Phase.PREPARING, _Phase.RAISED, _Phase.LOWERED)
