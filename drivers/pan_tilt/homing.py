"""Letting the drives find their zero."""

from __future__ import annotations

import struct
import time
from collections.abc import Callable, Sequence
from math import radians

from drivers.pan_tilt.axis import Axis
from drivers.pan_tilt.motion import Command
from drivers.pan_tilt.objects import (
    ACKNOWLEDGED,
    HOME_OFFSET,
    HOMING_ACCELERATION,
    HOMING_METHOD,
    HOMING_SPEEDS,
    HOMING_START,
    MODE_ERROR,
    TARGET_REACHED,
    Mode,
)
from drivers.pan_tilt.settings import HomingSettings, PanTiltSettings
from drivers.pan_tilt.setup import Setup, working_mode
from drivers.pan_tilt.states import ENABLE_OPERATION, State
from drivers.pan_tilt.trouble import Trouble

_SWITCH = 2.0  # [s]
_SETTLE = 3  # cycles in which the statusword comes to be the mode's
_SLOWLY = 0.1  # speed off the switch as a share of that to it
_SPEED_UP = 0.25  # time to the search's speed [s]

Cycle = Callable[[Sequence[Command]], None]


def home(axes: Sequence[Axis], settings: PanTiltSettings, setup: Callable[[Axis], Setup], cycle: Cycle) -> None:
    """Home both axes at once, and go back to the working mode.

    Args:
        axes: Drives in operation.
        settings: How.
        setup: Returns what talks to a drive.
        cycle: Sends commands and makes the drives measure.

    Raises:
        Trouble: A drive cannot be homed.
    """
    how = settings.homing or HomingSettings()
    for axis in axes:
        _prepare(setup(axis), axis, how)
    _change_mode(axes, Mode.HOMING, setup, cycle)
    _run(axes, how, cycle)
    _change_mode(axes, working_mode(settings), setup, cycle)


def _prepare(drive: Setup, axis: Axis, how: HomingSettings) -> None:
    speed = radians(how.speed_deg) * abs(axis.units)
    offset = axis.to_units(radians(how.pan_offset_deg if axis.name == "pan" else how.tilt_offset_deg))
    drive.write(HOMING_METHOD, 0, struct.pack("<b", how.method))
    drive.write(HOME_OFFSET, 0, struct.pack("<i", offset))
    drive.write_u32(HOMING_SPEEDS, speed, sub=1)
    drive.write_u32(HOMING_SPEEDS, max(speed * _SLOWLY, 1), sub=2)
    drive.write_u32(HOMING_ACCELERATION, max(speed / _SPEED_UP, 1))


def _change_mode(axes: Sequence[Axis], mode: Mode, setup: Callable[[Axis], Setup], cycle: Cycle) -> None:
    for axis in axes:
        setup(axis).set_mode(mode)
    end = time.monotonic() + _SWITCH
    while any(axis.mode != mode for axis in axes):
        cycle([(ENABLE_OPERATION, axis.position) for axis in axes])
        if time.monotonic() > end:
            raise Trouble(f"{axes[0]} or {axes[1]} does not change to mode {mode.value} (is homing supported?)")


def _run(axes: Sequence[Axis], how: HomingSettings, cycle: Cycle) -> None:
    """Raise the start's bit from low to high and wait for the result."""
    for _ in range(_SETTLE):
        cycle([(ENABLE_OPERATION, axis.position) for axis in axes])
    end, cycles = time.monotonic() + how.timeout, 0
    while cycles < _SETTLE or not all(_attained(axis) for axis in axes):
        cycle([(ENABLE_OPERATION | HOMING_START, axis.position) for axis in axes])
        cycles += 1
        for axis in axes:
            if cycles >= _SETTLE:
                _check(axis)
        if time.monotonic() > end:
            raise Trouble(f"homing took longer than {how.timeout:g} s (raise homing.timeout or homing.speed_deg?)")
    for _ in range(_SETTLE):
        cycle([(ENABLE_OPERATION, axis.position) for axis in axes])


def _attained(axis: Axis) -> bool:
    done = ACKNOWLEDGED | TARGET_REACHED
    return axis.statusword & (done | MODE_ERROR) == done


def _check(axis: Axis) -> None:
    if axis.statusword & MODE_ERROR:
        raise Trouble(f"{axis} cannot be homed (does it know the method, and do its switches work?)")
    if axis.state is not State.ENABLED:
        raise Trouble(f"{axis}: {axis.fault()}")
