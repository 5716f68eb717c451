"""Whether somebody on a CAN bus has a node number already."""

from __future__ import annotations

import time
from collections.abc import Collection
from typing import TYPE_CHECKING

from drivers.pan_tilt.objects import SDO_ANSWER, SDO_REQUEST

if TYPE_CHECKING:
    import can

_READ_DEVICE_TYPE = bytes([0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0])  # SDO upload of object 1000
_PATIENCE = 0.15  # within which a node answers [s]


def nodes_present(bus: can.BusABC, numbers: Collection[int]) -> list[int]:
    """Return which of these node numbers answer on the bus.

    Raises:
        can.CanError: The bus fails.
    """
    import can

    for number in numbers:
        bus.send(can.Message(arbitration_id=SDO_REQUEST + number, data=_READ_DEVICE_TYPE, is_extended_id=False))
    present: set[int] = set()
    end = time.monotonic() + _PATIENCE
    while (left := end - time.monotonic()) > 0:
        message = bus.recv(left)
        if message is not None and message.arbitration_id - SDO_ANSWER in numbers:
            present.add(message.arbitration_id - SDO_ANSWER)
    return sorted(present)
