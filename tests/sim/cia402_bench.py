"""A body for drives to move, a bus of its own, and a plain CANopen master."""

from __future__ import annotations

import contextlib
import math
import time
import uuid
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import canopen

from sim.devices.cia402 import Cia402Drives, object_dictionary
from zavis_bt.types import PanTiltSpec

SPEC = PanTiltSpec(-2.0, 2.0, -0.8, 0.5, 6.0, 40.0)
PAN, TILT = 1, 2
DEGREE = 1000


class Body:
    """Nothing but time and joints."""

    def __init__(self) -> None:
        self.spec: Any = SimpleNamespace(pan_tilt=SPEC)
        self.joints: Callable[[float], tuple[float, float]] = lambda stamp: (0.0, 0.0)
        self._begun = time.monotonic()

    @property
    def now(self) -> float:
        return time.monotonic() - self._begun

    @property
    def degrees(self) -> tuple[float, float]:
        pan, tilt = self.joints(self.now)
        return math.degrees(pan), math.degrees(tilt)


def eventually(condition: Callable[[], object], seconds: float = 10.0) -> bool:
    """Wait until a condition holds; return whether it did in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True


@contextlib.contextmanager
def unit(**options: Any) -> Iterator[tuple[Cia402Drives, Body, dict[str, Any]]]:
    """Run drives on a bus of their own; yield them, their body, and how to reach the bus."""
    bus = {"interface": "virtual", "channel": uuid.uuid4().hex}
    body = Body()
    drives = Cia402Drives(body, **bus, **options)
    drives.start()
    try:
        yield drives, body, bus
    finally:
        drives.close()


@contextlib.contextmanager
def master(bus: dict[str, Any], kind: type = canopen.RemoteNode) -> Iterator[tuple[canopen.Network, Any, Any]]:
    """Join a bus as a master; yield the network and both nodes, operational and with SYNC going."""
    network = canopen.Network()
    network.NOTIFIER_CYCLE = 0.05
    network.connect(**bus)
    nodes = [network.add_node(kind(number, object_dictionary(number))) for number in (PAN, TILT)]
    for node in nodes:
        node.sdo.RESPONSE_TIMEOUT = 2.0
        for limit in ("SWITCH_OP_MODE", "SWITCH_STATE_FINAL", "SWITCH_STATE_SINGLE", "CHECK_TPDO"):
            setattr(node, f"TIMEOUT_{limit}", 5.0)
        node.nmt.state = "PRE-OPERATIONAL"
    try:
        yield network, *nodes
    finally:
        network.sync.stop()
        network.disconnect()
