"""Homing: the drive finds its zero."""

from __future__ import annotations

from enum import Enum
from typing import Protocol

from drivers.pan_tilt.objects import (
    ACKNOWLEDGED,
    HALT,
    HOME_OFFSET,
    HOMING_ACCELERATION,
    HOMING_METHOD,
    HOMING_SPEEDS,
    HOMING_START,
    MODE_ERROR,
    TARGET_REACHED,
)
from sim.devices.cia402.modes import NoMode
from sim.devices.cia402.servo import Servo

_HERE = (35, 37)
_NEGATIVE_SWITCH, _POSITIVE_SWITCH = 17, 18


class Switches(Protocol):
    """The limit switches of an axis."""

    def pressed(self, now: float, *, positive: bool) -> bool:
        """Return whether the switch at that end is."""


class _Phase(Enum):
    IDLE = TARGET_REACHED
    TO_SWITCH = 0
    OFF_SWITCH = 1
    SETTLING = ACKNOWLEDGED
    DONE = ACKNOWLEDGED | TARGET_REACHED
    FAILED = MODE_ERROR | TARGET_REACHED

    @property
    def searches(self) -> bool:
        return self in (_Phase.TO_SWITCH, _Phase.OFF_SWITCH)


class Homing(NoMode):
    """Methods 35 and 37 take the present position, 17 and 18 the release of the negative or positive limit switch."""

    def __init__(self, servo: Servo, switches: Switches) -> None:
        super().__init__(servo)
        self._switches = switches
        self._phase = _Phase.IDLE
        self._positive = False

    def control(self, now: float, word: int, before: int) -> None:
        """Start with a rising edge; end without a result when the bit falls or a halt is asked for."""
        if word & HALT or (before & ~word & HOMING_START and self._phase.searches):
            if self._phase.searches:
                self._servo.brake(now, self._acceleration)
                self._phase = _Phase.IDLE
        elif word & ~before & HOMING_START:
            self._start(now)

    def tick(self, now: float) -> None:
        """Watch the switches."""
        pressed = self._switches.pressed(now, positive=self._positive)
        if self._phase is _Phase.TO_SWITCH and pressed:
            self._run(now, away=True)
            self._phase = _Phase.OFF_SWITCH
        elif self._phase is _Phase.OFF_SWITCH and not pressed and self._leaves(now):
            self._set_home(now)
            self._servo.brake(now, self._acceleration)
            self._phase = _Phase.SETTLING
        elif self._phase is _Phase.SETTLING and self._servo.at_rest(now):
            self._phase = _Phase.DONE

    def status(self, now: float) -> int:
        """Return attained, error and target reached."""
        return 0 if self._phase.searches else self._phase.value

    def _start(self, now: float) -> None:
        method = self._servo.value(HOMING_METHOD)
        if method in _HERE:
            self._servo.brake(now, self._acceleration)
            self._set_home(now)
            self._phase = _Phase.SETTLING
        elif method in (_NEGATIVE_SWITCH, _POSITIVE_SWITCH):
            self._positive = method == _POSITIVE_SWITCH
            self._run(now, away=False)
            self._phase = _Phase.TO_SWITCH
        else:
            self._phase = _Phase.FAILED

    def _set_home(self, now: float) -> None:
        self._servo.origin = self._servo.axis.at(now)[0] - self._servo.value(HOME_OFFSET)

    def _run(self, now: float, *, away: bool) -> None:
        """Turn to the switch at the search's speed or off it at the slow one; the software limits do not count."""
        speed = self._servo.value(HOMING_SPEEDS, 2 if away else 1)
        self._servo.axis.run(now, speed if self._positive != away else -speed, self._acceleration)

    def _leaves(self, now: float) -> bool:
        speed = self._servo.at(now)[1]
        return speed < 0 if self._positive else speed > 0

    @property
    def _acceleration(self) -> float:
        return float(max(self._servo.value(HOMING_ACCELERATION), 1))
