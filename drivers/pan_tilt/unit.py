"""Both drives together: cycles of commands and measurements, and bringing them into operation."""

from __future__ import annotations

import struct
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence

from drivers.pan_tilt.axis import Axis
from drivers.pan_tilt.emergencies import describe
from drivers.pan_tilt.line import Line
from drivers.pan_tilt.motion import Command
from drivers.pan_tilt.objects import ERROR_CODE, FAULT_RESET, NMT_PRE_OPERATIONAL, NMT_START, RPDO1, Mode
from drivers.pan_tilt.pace import Pace
from drivers.pan_tilt.settings import PanTiltSettings
from drivers.pan_tilt.setup import Identity, Setup, working_mode
from drivers.pan_tilt.states import DISABLE_VOLTAGE, QUICK_STOP, State, towards_operation
from drivers.pan_tilt.trouble import Trouble
from zavis_bt.types import PanTiltSpec

_RPDO1 = struct.Struct("<Hi")
_ENABLE = 3.0  # [s]
_RESET = 0.5  # time in which a fault must let itself be reset [s]
_REST = 1.0  # [s]
_AT_REST = 0.01  # [rad/s]
_I32 = 2**31 - 1

Measured = Callable[[float, float, float], None]


class Unit:
    """Two drives on a bus. One thread uses it; what the drives send comes in by the bus's own."""

    def __init__(
        self, settings: PanTiltSettings, spec: PanTiltSpec, now: Callable[[], float], measured: Measured
    ) -> None:
        """Know the drives; nothing is opened.

        Args:
            settings: Bus, nodes, units.
            spec: Limits.
            now: The mission's clock [s].
            measured: Called with the time [s], pan and tilt [rad] of each measurement of both axes.
        """
        self._settings, self._spec, self._now, self._measured = settings, spec, now, measured
        signs = (-1 if settings.pan_inverted else 1), (-1 if settings.tilt_inverted else 1)
        self.pan = Axis("pan", settings.pan_node, signs[0] * settings.units)
        self.tilt = Axis("tilt", settings.tilt_node, signs[1] * settings.units)
        self.axes = (self.pan, self.tilt)
        self.identities: tuple[Identity, ...] = ()
        """Name plates of the drives, pan first; empty before `open`."""
        self.pace = Pace(settings.period)
        self.latencies: deque[float] = deque(maxlen=2000)
        """Times from SYNC to the measurements of both axes [s]."""
        self.giving_up = threading.Event()
        """Set to end what takes long."""
        self._homed = False
        self._line: Line | None = None
        self._cycle, self._answered = 0, {axis.node: 0 for axis in self.axes}
        self._sync_stamp = self._sync_moment = 0.0

    def open(self) -> None:
        """Open the bus if need be, and bring both drives into operation at rest.

        Where homing is asked for, they are homed the first time, and after a drive has started anew.

        Raises:
            Trouble: Something is in the way.
        """
        line = self._open_line()
        self._homed &= not any(axis.restarted for axis in self.axes)
        for axis in self.axes:
            axis.forget()
            line.command(axis.node, NMT_PRE_OPERATIONAL)
        self.identities = tuple(self._setup(axis).run(self._spec) for axis in self.axes)
        for axis in self.axes:
            line.command(axis.node, NMT_START)
        line.beat()
        self.pace.restart()
        self._enable()
        if self._settings.homing is not None and not self._homed:
            self._home()

    def cycle(self, commands: Sequence[Command]) -> None:
        """Wait for the next beat, then command both drives and make them measure.

        Raises:
            Trouble: The bus takes no frames.
        """
        self.pace.wait()
        line = self._open_line()
        for axis, (word, target) in zip(self.axes, commands, strict=True):
            line.send(RPDO1 + axis.node, _RPDO1.pack(word, min(max(target, -_I32), _I32)))
        self._cycle += 1
        self._sync_stamp, self._sync_moment = self._now(), time.monotonic()
        line.sync()

    def problem(self) -> str:
        """Return why the drives cannot move, in plain words; empty if they can."""
        return next((found for axis in self.axes if (found := self._problem(axis))), "")

    def brake(self) -> None:
        """Quick-stop both drives, and wait for the rest a second at most.

        Raises:
            Trouble: The bus takes no frames.
        """
        end = time.monotonic() + _REST
        while time.monotonic() < end:
            self.idle(self.pace.period)
            if not any(self._moves(axis) for axis in self.axes):
                return

    def idle(self, seconds: float) -> None:
        """Keep measuring, with both drives told to stand, for a while.

        Raises:
            Trouble: The bus takes no frames.
        """
        end = time.monotonic() + seconds
        while True:
            self.cycle([(QUICK_STOP, axis.position) for axis in self.axes])
            if time.monotonic() >= end or self.giving_up.is_set():
                return

    def switch_off(self) -> None:
        """Take the voltage off both drives and end the exchange of process data.

        Raises:
            Trouble: The bus takes no frames.
        """
        for _ in range(3):
            self.cycle([(DISABLE_VOLTAGE, axis.position) for axis in self.axes])
        for axis in self.axes:
            self._open_line().command(axis.node, NMT_PRE_OPERATIONAL)

    def close(self) -> None:
        """Leave the bus; never raises."""
        line, self._line = self._line, None
        if line is not None:
            line.close()

    def set_profile(self, axis: Axis, rate: float, acceleration: float) -> None:
        """Give a drive the rate [rad/s] and acceleration [rad/s²] of its own moves.

        Raises:
            Trouble: It does not answer, or refuses.
        """
        self._setup(axis).set_profile(rate, acceleration)

    def _setup(self, axis: Axis) -> Setup:
        if self.giving_up.is_set():
            raise Trouble("is being closed")
        return Setup(self._open_line(), axis, self._settings)

    def _open_line(self) -> Line:
        if self._line is not None and self._line.broken:
            self.close()
        if self._line is None:
            self._line = Line(self._settings, self._receive)
        return self._line

    def _receive(self, identifier: int, data: bytes) -> None:
        axis = next((axis for axis in self.axes if axis.node == identifier & 0x7F), None)
        if axis is None or not axis.receive(identifier, data):
            return
        self._answered[axis.node] = self._cycle
        if all(answered == self._cycle for answered in self._answered.values()):
            self.latencies.append(time.monotonic() - self._sync_moment)
            self._measured(self._sync_stamp, self.pan.angle, self.tilt.angle)

    def _problem(self, axis: Axis) -> str:
        if axis.restarted:
            return f"{axis} has restarted by itself (does its supply break down under load?)"
        if not axis.operational and not self._silent(axis):
            return f"{axis} was taken out of operation by somebody else on the bus (run one master only)"
        if self._silent(axis):
            return f"{axis} does not answer (is it powered, and its bus cable plugged in?)"
        state = axis.state
        if state is not None and state.faulty:
            return f"{axis}: {axis.fault()}"
        if state is not State.ENABLED:
            return f"{axis} is in '{state.text if state else 'no known state'}' (has somebody else switched it off?)"
        return ""

    def _moves(self, axis: Axis) -> bool:
        known = not (axis.restarted or self._silent(axis)) and axis.operational
        return known and abs(axis.velocity / axis.units) > _AT_REST

    def _silent(self, axis: Axis) -> bool:
        settings, now = self._settings, time.monotonic()
        missed = (self._cycle - self._answered[axis.node]) * self.pace.period > settings.answer_timeout
        unheard = missed and now - axis.heard > settings.answer_timeout
        return unheard or now - max(axis.beaten, axis.heard) > settings.heartbeat_timeout

    def _enable(self) -> None:
        """Lead both drives to operation; each holds the place where it stands."""
        begin, mode = time.monotonic(), working_mode(self._settings)
        goals = [axis.position for axis in self.axes]
        while not all(axis.state is State.ENABLED and axis.mode == mode for axis in self.axes):
            commands = []
            for number, axis in enumerate(self.axes):
                if axis.state is not State.ENABLED:
                    goals[number] = axis.position
                commands.append((self._towards_operation(axis), goals[number]))
            self._cycle_or_give_up(commands)
            self._check_progress(time.monotonic() - begin, mode)

    def _towards_operation(self, axis: Axis) -> int:
        if axis.heard < 0:
            return DISABLE_VOLTAGE
        if axis.state is State.FAULT:
            return FAULT_RESET if self._cycle // 2 % 2 else DISABLE_VOLTAGE  # the edge resets
        return towards_operation(axis.state)

    def _check_progress(self, elapsed: float, mode: Mode) -> None:
        for axis in self.axes:
            if elapsed > _RESET and axis.state is State.FAULT:
                code = self._setup(axis).read_number(ERROR_CODE)
                raise Trouble(f"{axis}: {describe(code) if code else axis.fault()}")
            if elapsed < _ENABLE or (axis.state is State.ENABLED and axis.mode == mode):
                continue
            if axis.heard < 0:
                raise Trouble(f"{axis} answers, but sends no measurements (does its TPDO 1 answer SYNC?)")
            state = axis.state.text if axis.state else "no known state"
            raise Trouble(f"{axis} stays in '{state}', mode {axis.mode} (is its power stage supplied and released?)")

    def _home(self) -> None:
        from drivers.pan_tilt.homing import home

        home(self.axes, self._settings, self._setup, self._cycle_or_give_up)
        self._enable()
        self._homed = True

    def _cycle_or_give_up(self, commands: Sequence[Command]) -> None:
        if self.giving_up.is_set():
            raise Trouble("is being closed")
        self.cycle(commands)
        for axis in self.axes:
            if axis.heard > 0 and self._silent(axis):
                raise Trouble(self._problem(axis))
