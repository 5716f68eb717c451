"""Faults by hand: a small language to break simulated devices with, and to mend them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from sim.devices.serve import SimulatedDevices
from zavis_bt.errors import DeviceError, InputError, did_you_mean

HELP = """\
base cut [SECONDS]            the base's line is gone: clients are cut off, new ones refused
lidar silent [SECONDS]        the LiDAR stays connected and sends nothing
lidar cut [SECONDS]           the LiDAR's line is gone
camera freeze [SECONDS]       the camera stays connected and takes no new pictures
camera cut [SECONDS]          the camera's line is gone
can silent pan|tilt|both [SECONDS]
                              drives of the pan-tilt unit are cut off the CAN bus
can restart pan|tilt|both     drives lose their power for a moment
emcy pan|tilt CODE [SECONDS]  a drive fails with this error code (hexadecimal, e.g. 8611 following error)
estop [SECONDS]               somebody presses the emergency stop
battery LEVEL                 state of charge, 0 to 1 or in percent: battery 0.05, battery 5%
mend                          everything is well again (a drive's fault is reset by its master)
help                          this list
Without SECONDS a fault lasts until mend."""

_AXES = ("pan", "tilt")


class _Fault(NamedTuple):
    what: str
    end: Callable[[], None]
    timer: threading.Timer | None


class FaultDesk:
    """Takes commands as a person types them. Any thread may; faults with a time end by themselves."""

    def __init__(self, devices: SimulatedDevices) -> None:
        """Break nothing yet.

        Args:
            devices: What can be broken; they must have been started.
        """
        self._devices = devices
        self._faults: dict[str, _Fault] = {}
        self._lock = threading.RLock()
        self._commands: Mapping[str, Callable[[Sequence[str]], str]] = {
            "base": lambda words: self._line("base", words),
            "lidar": self._lidar,
            "camera": self._camera,
            "can": self._can,
            "emcy": self._emergency,
            "estop": self._emergency_stop,
            "battery": self._battery,
            "mend": self._mend,
            "help": lambda words: HELP,
        }

    @property
    def faults(self) -> tuple[str, ...]:
        """What is broken now, in words."""
        with self._lock:
            return tuple(fault.what for fault in self._faults.values())

    def do(self, line: str) -> str:
        """Obey one line.

        Args:
            line: A command, see `HELP`; case and further blanks mean nothing.

        Returns:
            What was done, for the person; empty for an empty line.

        Raises:
            InputError: It is no command; the message says what would be one.
        """
        words = line.lower().split()
        if not words:
            return ""
        if words[0] not in self._commands:
            raise InputError(f"{words[0]}: unknown{did_you_mean(words[0], self._commands)}")
        with self._lock:
            return self._commands[words[0]](words[1:])

    def close(self) -> None:
        """Wait for nothing any more; what is broken stays broken."""
        with self._lock:
            for fault in self._faults.values():
                if fault.timer is not None:
                    fault.timer.cancel()
            self._faults.clear()

    # -- commands --------------------------------------------------------------------------------------------------

    def _line(self, kind: str, words: Sequence[str]) -> str:
        rest = _after(kind, words, "cut")
        seconds = _seconds(rest)
        if f"{kind} cut" not in self._faults:
            self._devices.cut(kind)
        return self._break(f"{kind} cut", seconds, lambda: self._devices.reconnect(kind))

    def _lidar(self, words: Sequence[str]) -> str:
        if words[:1] == ["cut"]:
            return self._line("lidar", words)
        seconds = _seconds(_after("lidar", words, "silent", "cut"))
        self._devices.lidar.silent = True
        return self._break("lidar silent", seconds, lambda: setattr(self._devices.lidar, "silent", False))

    def _camera(self, words: Sequence[str]) -> str:
        if words[:1] == ["cut"]:
            return self._line("camera", words)
        seconds = _seconds(_after("camera", words, "freeze", "cut"))
        self._devices.camera.freeze()
        return self._break("camera freeze", seconds, lambda: self._devices.camera.thaw())

    def _can(self, words: Sequence[str]) -> str:
        restart = words[:1] == ["restart"]
        rest = _after("can", words, "silent", "restart")
        axes, rest = _axes("can", rest)
        unit = self._devices.pan_tilt
        if restart:
            _seconds(rest, allowed=False)
            for axis in axes:
                unit.restart(axis)
            return f"restarted: {' and '.join(axes)}"
        seconds = _seconds(rest)
        for axis in axes:
            unit.silence(axis)
        return "\n".join([self._break(f"can silent {axis}", seconds, _resume(unit.resume, axis)) for axis in axes])

    def _emergency(self, words: Sequence[str]) -> str:
        axes, rest = _axes("emcy", words)
        code, seconds = _error_code(rest), _seconds(rest[1:]) or 0.0
        for axis in axes:
            self._devices.pan_tilt.raise_emergency(axis, code, seconds)
        lasts = f", its cause lasts {seconds:g} s" if seconds else ""
        return f"emergency {code:04X} of {' and '.join(axes)}{lasts}"

    def _emergency_stop(self, words: Sequence[str]) -> str:
        seconds = _seconds(words)
        self._devices.plant.estop = True
        return self._break("estop", seconds, lambda: setattr(self._devices.plant, "estop", False))

    def _battery(self, words: Sequence[str]) -> str:
        level = _level(words)
        self._devices.plant.charge = level
        if level < 1.0:
            return self._break(f"battery {level:.0%}", None, lambda: setattr(self._devices.plant, "charge", 1.0))
        self._forget("battery")
        return "battery full"

    def _mend(self, words: Sequence[str]) -> str:
        _seconds(words, allowed=False)
        was = self.faults
        for name in tuple(self._faults):
            self._end(name)
        return f"mended: {', '.join(was)}" if was else "nothing was broken"

    # -- faults that last ------------------------------------------------------------------------------------------

    def _break(self, what: str, seconds: float | None, end: Callable[[], None]) -> str:
        """Note a fault that has begun, and when it is to end."""
        name = "battery" if what.startswith("battery") else what
        self._forget(name)
        timer = None
        if seconds is not None:
            timer = threading.Timer(seconds, self._end, (name,))
            timer.daemon = True
        self._faults[name] = _Fault(what, end, timer)
        if timer is None:
            return f"{what} (until mend)"
        timer.start()
        return f"{what} for {seconds:g} s"

    def _forget(self, name: str) -> None:
        fault = self._faults.pop(name, None)
        if fault is not None and fault.timer is not None:
            fault.timer.cancel()

    def _end(self, name: str) -> None:
        with self._lock:
            fault = self._faults.get(name)
            self._forget(name)
            if fault is None:
                return
            try:
                fault.end()
            except DeviceError as error:  # somebody else has taken the port meanwhile: 'mend' tries again
                self._faults[name] = _Fault(f"{fault.what}: {error}", fault.end, None)


def _resume(resume: Callable[[str], None], axis: str) -> Callable[[], None]:
    return lambda: resume(axis)


# -- reading words -------------------------------------------------------------------------------------------------


def _after(command: str, words: Sequence[str], *choices: str) -> Sequence[str]:
    """Return the words behind the first one, which must be one of the choices."""
    if not words or words[0] not in choices:
        raise InputError(f"{command}: {' or '.join(choices)}? (e.g. {command} {choices[0]} 5)")
    return words[1:]


def _axes(command: str, words: Sequence[str]) -> tuple[tuple[str, ...], Sequence[str]]:
    if not words or words[0] not in (*_AXES, "both"):
        raise InputError(f"{command}: which axis? (pan, tilt or both)")
    return (_AXES if words[0] == "both" else (words[0],)), words[1:]


def _error_code(words: Sequence[str]) -> int:
    text = words[0] if words else "8611"
    try:
        code = int(text, 16)
    except ValueError:
        code = -1
    if not 0 < code <= 0xFFFF:
        raise InputError(f"emcy: '{text}' is no error code (hexadecimal, 1 to FFFF, e.g. 8611)")
    return code


def _seconds(words: Sequence[str], *, allowed: bool = True) -> float | None:
    if not words:
        return None
    try:
        seconds = float(words[0].removesuffix("s"))
    except ValueError:
        seconds = -1.0
    if not allowed or len(words) > 1 or not 0 < seconds < 1e6:
        raise InputError(f"'{' '.join(words)}': not understood here{' (seconds, e.g. 5)' if allowed else ''}")
    return seconds


def _level(words: Sequence[str]) -> float:
    text = words[0] if len(words) == 1 else ""
    try:
        level = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        level = -1.0
    if not 0 <= level <= 1:
        raise InputError(f"battery: '{' '.join(words)}' is no state of charge (0 to 1, e.g. 0.05, or 5%)")
    return level
