"""A mission's pan-tilt unit of two drives on a CAN bus."""

from __future__ import annotations

import atexit
import contextlib
import math
import threading
import time
from collections.abc import Mapping
from typing import Any, NamedTuple

from drivers.pan_tilt.history import AngleHistory
from drivers.pan_tilt.motion import CyclicMotion, Motion, ProfileMotion
from drivers.pan_tilt.report import describe_unit
from drivers.pan_tilt.settings import PanTiltSettings
from drivers.pan_tilt.trajectory import Trajectory
from drivers.pan_tilt.trouble import Trouble
from drivers.pan_tilt.unit import Unit
from drivers.settings import read_settings
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import DeviceReport, PanTiltState

_FIRST_PAUSE, _LONGEST_PAUSE = 0.2, 2.0  # between attempts to get going again [s]
_SPEED_UP = 0.1  # time to the greatest acceleration unless the settings say otherwise [s]
_HALT, _JOIN = 1.5, 6.0  # [s]
_STILL = 0.1  # an axis is at rest if it takes longer than this to turn by the tolerance [s]


class _Wish(NamedTuple):
    number: int
    target: tuple[float, float] | None
    """Where to go [rad]; None to come to rest."""


class _Told(NamedTuple):
    number: int
    """Of the last wish that was taken up."""
    settled: bool
    fault: str


class CanPanTilt:
    """Two CiA 402 drives on CANopen.

    A thread of it runs the cycles; the bus's thread takes in what the drives measure. `state` and `angles_at` only
    read what is there. After a fault it gets going again by itself, at rest: an old target is not taken up again.
    """

    def __init__(self, settings: PanTiltSettings, context: DeviceContext) -> None:
        """Bring the drives into operation, home them if that is asked for, and hold them where they stand.

        Raises:
            DeviceError: The bus cannot be opened or a drive cannot be used: one line with the remedy.
        """
        self._settings, self._where, self._spec = settings, context.where, context.spec.pan_tilt
        self._history = AngleHistory()
        self._unit = Unit(settings, self._spec, context.clock.now, self._history.add)
        self._tolerance = math.radians(settings.tolerance_deg)
        self._lock = threading.Lock()
        self._wish, self._told = _Wish(0, None), _Told(0, True, "")
        self._faults = 0
        self._closing = self._unit.giving_up
        try:
            self._unit.open()
        except Trouble as trouble:
            self._unit.close()
            raise DeviceError(f"{self._where}: {trouble}") from trouble
        self._thread = threading.Thread(target=self._run, name="pan-tilt cycle", daemon=True)
        atexit.register(self.close)
        self._thread.start()

    def state(self) -> PanTiltState:
        """Return the latest joint angles; while a drive is not heard of the stamp stands still."""
        stamp, pan, tilt = self._history.latest
        told = self._told
        settled = told.settled and told.number == self._wish.number
        return PanTiltState(pan, tilt, settled, stamp, told.fault)

    def angles_at(self, stamp: float) -> tuple[float, float]:
        """Return pan and tilt [rad] at a time within the last seconds [s]."""
        return self._history.at(stamp)

    def move_to(self, pan: float, tilt: float) -> None:
        """Start a move to these angles [rad], clipped to the limits; both axes arrive together.

        Raises:
            ValueError: An angle is not a number.
            DeviceError: The unit cannot move now.
        """
        if math.isnan(pan) or math.isnan(tilt):
            raise ValueError(f"pan {pan}, tilt {tilt}: not an angle")
        fault = "is closed" if self._closing.is_set() else self._told.fault
        if fault:
            raise DeviceError(f"{self._where}: {fault}")
        spec = self._spec
        target = min(max(pan, spec.pan_min), spec.pan_max), min(max(tilt, spec.tilt_min), spec.tilt_max)
        with self._lock:
            if self._wish.target != target:
                self._wish = _Wish(self._wish.number + 1, target)

    def stop(self) -> None:
        """Come to rest as fast as the limits allow; never raises."""
        with self._lock:
            self._wish = _Wish(self._wish.number + 1, None)

    def report(self) -> DeviceReport:
        """Return what the drives are, how well the bus and the cycle keep time, and what is wrong."""
        return describe_unit(self._unit, self._settings, self._told.fault, self._faults)

    def close(self) -> None:
        """Come to rest, take the voltage off, leave the bus; never raises, may be called twice."""
        if self._closing.is_set():
            return
        self._closing.set()
        atexit.unregister(self.close)
        if threading.current_thread() is not self._thread:
            self._thread.join(_JOIN)

    def _run(self) -> None:
        try:
            self._work()
        finally:
            if not self._closing.is_set():  # without this thread the drives miss their heartbeat and stop
                self._told = _Told(self._wish.number, False, "its driver has failed (a bug: see the traceback)")

    def _work(self) -> None:
        while not self._closing.is_set():
            try:
                self._operate()
            except Trouble as trouble:
                self._fail(str(trouble))
                self._recover()
        with contextlib.suppress(Trouble):  # a bus that takes no frames cannot be told to switch off either
            self._unit.switch_off()
        self._unit.close()

    def _operate(self) -> None:
        """Fulfil wishes until the device is closed; then come to rest.

        Raises:
            Trouble: The drives cannot move any more.
        """
        motion, number = self._start_motion(), self._told.number
        end = math.inf
        while time.monotonic() < end:
            if self._closing.is_set() and math.isinf(end):
                motion.halt()
                end = time.monotonic() + _HALT
            elif self._wish.number != number:
                number = self._take_up(motion)
            self._unit.cycle(motion.step())
            problem = self._unit.problem()
            if problem:
                raise Trouble(problem)
            self._told = _Told(number, self._settled(motion), "")
            if motion.done and math.isfinite(end):
                return

    def _start_motion(self) -> Motion:
        if self._settings.mode == "cyclic":
            jerk = self._settings.max_jerk_deg
            greatest = self._spec.max_acceleration / _SPEED_UP if jerk is None else math.radians(jerk)
            trajectory = Trajectory(self._spec, greatest, self._settings.period)
            motion: Motion = CyclicMotion(self._unit.axes, trajectory)
        else:
            motion = ProfileMotion(self._unit.axes, self._spec, self._unit.set_profile)
        motion.hold()
        return motion

    def _take_up(self, motion: Motion) -> int:
        number, target = self._wish
        if target is None:
            motion.halt()
        else:
            motion.go_to(target)
        return number

    def _settled(self, motion: Motion) -> bool:
        if not motion.done:
            return False
        return all(
            abs(axis.angle - goal) <= self._tolerance for axis, goal in zip(self._unit.axes, motion.goal, strict=True)
        )

    def _fail(self, fault: str) -> None:
        """Tell of a fault, drop what was wished for, and brake what can be braked."""
        self._faults += 1
        with self._lock:
            self._wish = _Wish(self._wish.number + 1, None)
        self._told = _Told(self._wish.number, False, fault)
        with contextlib.suppress(Trouble):  # the first one is what matters
            self._unit.brake()

    def _recover(self) -> None:
        """Try to get going again, with longer and longer pauses, until it works or the device is closed."""
        pause = _FIRST_PAUSE
        while not self._closing.is_set():
            try:
                self._unit.idle(pause)
                self._unit.open()
            except Trouble as trouble:
                self._told = _Told(self._wish.number, False, str(trouble))
                self._closing.wait(pause)
                pause = min(2 * pause, _LONGEST_PAUSE)
            else:
                self._told = _Told(self._wish.number, True, "")
                return


def open_pan_tilt(settings: Mapping[str, Any], context: DeviceContext) -> CanPanTilt:
    """Open the pan-tilt unit of a robot file.

    Raises:
        InputError: A setting is wrong.
        DeviceError: The bus cannot be opened or a drive cannot be used: one line with the remedy.
    """
    return CanPanTilt(read_settings(PanTiltSettings, settings, context.where), context)
