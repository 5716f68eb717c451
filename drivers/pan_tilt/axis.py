"""What is known of one drive from the frames it sends."""

from __future__ import annotations

import math
import struct
import time
from collections import deque

from drivers.pan_tilt.emergencies import clears, describe
from drivers.pan_tilt.objects import BOOT_UP, EMCY, HEARTBEAT, OPERATIONAL, TPDO1, TPDO2
from drivers.pan_tilt.states import State, decode_state

_TPDO1 = struct.Struct("<Hi")  # statusword, position
_TPDO2 = struct.Struct("<ib")  # velocity, mode
_EMCY = struct.Struct("<HB")
_HISTORY = 20


class Axis:
    """One drive. A bus's thread feeds it, any may read it."""

    def __init__(self, name: str, node: int, units: float) -> None:
        """Know nothing yet.

        Args:
            name: ``pan`` or ``tilt``.
            node: Its number on the bus.
            units: The drive's units in a radian, negative if it counts the other way.
        """
        self.name, self.node, self.units = name, node, units
        self.statusword, self.position, self.velocity, self.mode = 0, 0, 0, 0
        """As last measured, in the drive's units."""
        self.heard = self.beaten = -math.inf
        """Monotonic time of the last measurement and of the last heartbeat [s]."""
        self.communication: int | None = None
        """State of its communication (NMT) by its last heartbeat; None before."""
        self.emergency = 0
        """Error code that it has reported and not cleared; 0 for none."""
        self.emergencies: deque[tuple[float, int]] = deque(maxlen=_HISTORY)
        """Monotonic time [s] and code of the latest reports."""
        self.restarted = False
        """Whether it has started anew since `forget`."""

    def __str__(self) -> str:
        return f"{self.name} (node {self.node})"

    @property
    def state(self) -> State | None:
        """Of its state machine."""
        return decode_state(self.statusword)

    @property
    def angle(self) -> float:
        """Measured angle [rad]."""
        return self.position / self.units

    @property
    def operational(self) -> bool:
        """Whether it exchanges process data: it has sent some since its last heartbeat, or that says so."""
        return self.heard > self.beaten or self.communication in (None, OPERATIONAL)

    def to_units(self, angle: float) -> int:
        """Return an angle [rad], or its derivative, in the drive's units."""
        return round(angle * self.units)

    def forget(self) -> None:
        """Wait for news."""
        self.heard = self.beaten = -math.inf
        self.communication, self.restarted, self.emergency = None, False, 0

    def receive(self, identifier: int, data: bytes) -> bool:
        """Take a frame of its; return whether it was a measurement of the position."""
        service = identifier - self.node
        if service == TPDO1 and len(data) >= _TPDO1.size:
            self.statusword, self.position = _TPDO1.unpack_from(data)
            self.heard = time.monotonic()
            return True
        if service == TPDO2 and len(data) >= _TPDO2.size:
            self.velocity, self.mode = _TPDO2.unpack_from(data)
        elif service == HEARTBEAT and len(data) == 1:
            self._on_heartbeat(data[0] & 0x7F)
        elif service == EMCY and len(data) >= _EMCY.size:
            self._on_emergency(_EMCY.unpack_from(data)[0])
        return False

    def fault(self) -> str:
        """Return what its fault is, in words."""
        return describe(self.emergency) if self.emergency else "reports a fault without saying which"

    def _on_heartbeat(self, state: int) -> None:
        self.beaten = time.monotonic()
        self.communication = state
        self.restarted |= state == BOOT_UP

    def _on_emergency(self, code: int) -> None:
        self.emergencies.append((time.monotonic(), code))
        self.emergency = 0 if clears(code) else code
