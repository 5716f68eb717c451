"""The drives' side of the bus."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from typing import Any

import can
from canopen import Network

_NODE = 0x7F


class PeriodicFrame:
    """A frame that is sent again and again, by whoever calls `DriveNetwork.send_due`."""

    def __init__(self, identifier: int, data: Sequence[int], period: float) -> None:
        self.identifier, self.data, self.period = identifier, bytes(data), period
        self.due = 0.0
        self.stopped = False

    def update(self, data: Sequence[int]) -> None:
        """Send this from now on."""
        self.data = bytes(data)

    def stop(self) -> None:
        """Send it no more."""
        self.stopped = True


class DriveNetwork(Network):
    """A bus on which nodes can be made silent, and whose periodic frames need no threads."""

    def __init__(self, bus: can.BusABC) -> None:
        super().__init__(bus)
        self.silent: set[int] = set()
        """Nodes whose frames do not get out."""
        self._periodic: list[PeriodicFrame] = []

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        """Send a frame unless its node is silent; a bus that takes none loses it, as a drive would."""
        if can_id & _NODE in self.silent or self.bus is None:
            return
        frame = can.Message(arbitration_id=can_id, is_extended_id=False, is_remote_frame=remote, data=bytes(data))
        with contextlib.suppress(can.CanError, OSError):
            self.bus.send(frame)

    def send_periodic(self, can_id: int, data: Any, period: float, remote: bool = False) -> Any:
        """Return a frame that is sent every ``period`` seconds until it is stopped."""
        frame = PeriodicFrame(can_id, data, period)
        self._periodic.append(frame)
        return frame

    def send_due(self, now: float) -> None:
        """Send the periodic frames whose time has come [s]."""
        self._periodic = [frame for frame in self._periodic if not frame.stopped]
        for frame in self._periodic:
            if now >= frame.due:
                self.send_message(frame.identifier, frame.data)
                frame.due = max(frame.due + frame.period, now)
