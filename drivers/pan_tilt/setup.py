"""Preparing a drive over SDO: what it is, whom it watches, what it may do and what it exchanges."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass

from drivers.pan_tilt.axis import Axis
from drivers.pan_tilt.line import Line
from drivers.pan_tilt.objects import (
    ACCELERATION,
    CONSUMER_HEARTBEAT,
    CONTROLWORD,
    CYCLE_TIME,
    DECELERATION,
    DEVICE_NAME,
    DEVICE_TYPE,
    IDENTITY,
    MAX_VELOCITY,
    MODE,
    MODE_DISPLAY,
    PDO_OFF,
    POSITION,
    POSITION_LIMITS,
    PRODUCER_HEARTBEAT,
    PROFILE,
    PROFILE_VELOCITY,
    QUICK_STOP_DECELERATION,
    QUICK_STOP_OPTION,
    RPDO1,
    RPDO_MAPPING,
    RPDO_PARAMETER,
    SOFTWARE_VERSION,
    STATUSWORD,
    SUPPORTED_MODES,
    TARGET_POSITION,
    TPDO1,
    TPDO2,
    TPDO_MAPPING,
    TPDO_PARAMETER,
    VELOCITY,
    Mode,
    mapping,
)
from drivers.pan_tilt.settings import PanTiltSettings
from drivers.pan_tilt.trouble import Trouble
from zavis_bt.types import PanTiltSpec

_EVERY_SYNC = 1
_SWITCH_OFF_AFTER_STOP = 2  # quick stop option: on a ramp, then switch on disabled


@dataclass(frozen=True, slots=True)
class Identity:
    """A drive's name plate."""

    name: str
    software: str
    vendor: int
    product: int
    revision: int
    serial: int

    def __str__(self) -> str:
        return f"{self.name or 'CiA 402 drive'} (vendor {self.vendor:X}, product {self.product:X})"


def working_mode(settings: PanTiltSettings) -> Mode:
    """Return the mode of operation that moves are made in."""
    return Mode.CYCLIC_POSITION if settings.mode == "cyclic" else Mode.PROFILE_POSITION


def angle_limits(name: str, spec: PanTiltSpec) -> tuple[float, float]:
    """Return the least and greatest angle of an axis [rad]."""
    return (spec.pan_min, spec.pan_max) if name == "pan" else (spec.tilt_min, spec.tilt_max)


class Setup:
    """Talks to one drive before it moves. All of it may raise `Trouble`."""

    def __init__(self, line: Line, axis: Axis, settings: PanTiltSettings) -> None:
        self._line, self._axis, self._settings = line, axis, settings

    def run(self, spec: PanTiltSpec) -> Identity:
        """Find out what drive it is, and prepare it.

        Raises:
            Trouble: It is silent, no CiA 402 drive, cannot work as asked for, or refuses a setting.
        """
        identity = self._identify()
        self._require_modes()
        self._set_heartbeats()
        self._set_limits(spec)
        self._map()
        self.set_mode(working_mode(self._settings))
        return identity

    def set_mode(self, mode: Mode) -> None:
        """Ask for a mode of operation."""
        self.write(MODE, 0, struct.pack("<b", mode))

    def write(self, index: int, sub: int, data: bytes, *, optional: bool = False) -> None:
        """Set an object; one that is ``optional`` may be missing."""
        try:
            known = self._line.write(self._axis.node, index, sub, data)
        except Trouble as trouble:
            raise self._silent() if "answer" in str(trouble) else Trouble(f"{self._axis} {trouble}") from trouble
        if not known and not optional:
            raise Trouble(f"{self._axis} lacks object {index:04X}:{sub:X} (is its firmware one for CiA 402?)")

    def write_u32(self, index: int, value: float, *, sub: int = 0) -> None:
        """Set an optional object of 32 bits to the rounded value."""
        self.write(index, sub, struct.pack("<I", min(max(round(value), 0), 0xFFFF_FFFF)), optional=True)

    def set_profile(self, rate: float, acceleration: float) -> None:
        """Set the velocity [rad/s] and acceleration [rad/s²] of the drive's own moves."""
        units = abs(self._axis.units)
        self.write_u32(PROFILE_VELOCITY, max(rate * units, 1))
        for index in (ACCELERATION, DECELERATION):
            self.write_u32(index, max(acceleration * units, 1))

    def read_number(self, index: int, sub: int = 0) -> int | None:
        """Return an unsigned number, or None if the drive lacks it."""
        try:
            data = self._line.read(self._axis.node, index, sub)
        except Trouble as trouble:
            raise self._silent() if "answer" in str(trouble) else Trouble(f"{self._axis} {trouble}") from trouble
        return None if data is None else int.from_bytes(data, "little")

    def _silent(self) -> Trouble:
        remedy = "is it powered, its bus cable plugged in and terminated, and are node number and bitrate right?"
        return Trouble(f"{self._axis} does not answer ({remedy})")

    def _identify(self) -> Identity:
        kind = self.read_number(DEVICE_TYPE)
        if kind is None or kind & 0xFFFF != PROFILE:
            told = "none" if kind is None else f"{kind:08X}"
            raise Trouble(f"{self._axis} is no CiA 402 drive (its device type is {told}; is the node number right?)")
        name, software = self._text(DEVICE_NAME), self._text(SOFTWARE_VERSION)
        vendor, product, revision, serial = (self.read_number(IDENTITY, sub) or 0 for sub in range(1, 5))
        return Identity(name, software, vendor, product, revision, serial)

    def _text(self, index: int) -> str:
        try:
            data = self._line.read(self._axis.node, index)
        except Trouble:  # some drives keep names where SDO does not reach
            return ""
        return (data or b"").decode("ascii", errors="replace").strip("\0 ")

    def _require_modes(self) -> None:
        known = self.read_number(SUPPORTED_MODES)
        if known is None:
            return
        wanted = [working_mode(self._settings), *([Mode.HOMING] if self._settings.homing else [])]
        missing = [mode for mode in wanted if not known & mode.bit]
        if missing:
            name = missing[0].name.lower().replace("_", " ")
            raise Trouble(f"{self._axis} has no mode '{name}' (set 'mode' or 'homing' to what it has: {known:X})")

    def _set_heartbeats(self) -> None:
        settings = self._settings
        watch = settings.master_node << 16 | round(settings.heartbeat_timeout * 1000)
        self.write(CONSUMER_HEARTBEAT, 1, struct.pack("<I", watch))
        self.write(PRODUCER_HEARTBEAT, 0, struct.pack("<H", round(settings.heartbeat * 1000)))

    def _set_limits(self, spec: PanTiltSpec) -> None:
        axis, units = self._axis, abs(self._axis.units)
        low, high = sorted(angle * axis.units for angle in angle_limits(axis.name, spec))
        for sub, limit in enumerate((math.floor(low), math.ceil(high)), 1):
            self.write(POSITION_LIMITS, sub, struct.pack("<i", limit), optional=True)
        # Set-points that keep to the limits are rounded and smoothed on their way; the drive needs some room.
        self.write_u32(MAX_VELOCITY, spec.max_rate * units * 1.1)
        self.write_u32(QUICK_STOP_DECELERATION, spec.max_acceleration * units)
        self.write(QUICK_STOP_OPTION, 0, struct.pack("<h", _SWITCH_OFF_AFTER_STOP), optional=True)
        self.set_profile(spec.max_rate, spec.max_acceleration)
        period = round(self._settings.period * 1000)
        self.write(CYCLE_TIME, 1, struct.pack("<B", period), optional=True)
        self.write(CYCLE_TIME, 2, struct.pack("<b", -3), optional=True)

    def _map(self) -> None:
        node = self._axis.node
        command = mapping(CONTROLWORD, 0, 16), mapping(TARGET_POSITION, 0, 32)
        place = mapping(STATUSWORD, 0, 16), mapping(POSITION, 0, 32)
        motion = mapping(VELOCITY, 0, 32), mapping(MODE_DISPLAY, 0, 8)
        self._map_pdo(RPDO_PARAMETER, RPDO_MAPPING, RPDO1 + node, command)
        self._map_pdo(TPDO_PARAMETER, TPDO_MAPPING, TPDO1 + node, place)
        self._map_pdo(TPDO_PARAMETER + 1, TPDO_MAPPING + 1, TPDO2 + node, motion)
        # Whatever else the drive was once told to take or to send is not for us.
        self.write(RPDO_PARAMETER + 1, 1, struct.pack("<I", PDO_OFF | RPDO1 + 0x100 + node), optional=True)

    def _map_pdo(self, parameter: int, objects: int, identifier: int, words: tuple[int, ...]) -> None:
        self.write(parameter, 1, struct.pack("<I", PDO_OFF | identifier))
        self.write(parameter, 2, struct.pack("<B", _EVERY_SYNC))
        self.write(objects, 0, b"\0")
        for sub, word in enumerate(words, 1):
            self.write(objects, sub, struct.pack("<I", word))
        self.write(objects, 0, bytes([len(words)]))
        self.write(parameter, 1, struct.pack("<I", identifier))
