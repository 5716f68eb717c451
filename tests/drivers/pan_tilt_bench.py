"""A driver and the drives it commands, on a bus of their own."""

from __future__ import annotations

import contextlib
import math
import time
import uuid
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np

from drivers.pan_tilt import CanPanTilt, open_pan_tilt
from sim.devices.cia402 import Cia402Drives
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import PanTiltSpec, Pose2D

SPEC = PanTiltSpec(-2.0, 2.0, -0.8, 0.5, 8.0, 25.0)
WHERE = "my.robot.yaml: devices.pan_tilt"


class Body:
    """A clock, and joints that drives set."""

    def __init__(self) -> None:
        self.spec: Any = SimpleNamespace(pan_tilt=SPEC)
        self.joints: Callable[[float], tuple[float, float]] = lambda stamp: (0.0, 0.0)
        self._begun = time.monotonic()

    @property
    def now(self) -> float:
        return time.monotonic() - self._begun

    @property
    def angles(self) -> tuple[float, float]:
        return self.joints(self.now)

    def context(self) -> DeviceContext:
        clock: Any = SimpleNamespace(now=lambda: self.now)
        return DeviceContext(WHERE, self.spec, clock, Pose2D(0.0, 0.0), lambda stamp: np.eye(4))


def eventually(condition: Callable[[], object], seconds: float = 15.0) -> bool:
    """Wait until a condition holds; return whether it did in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True


def new_bus() -> dict[str, Any]:
    return {"interface": "virtual", "channel": uuid.uuid4().hex}


@contextlib.contextmanager
def drives_on(bus: dict[str, Any], **options: Any) -> Iterator[tuple[Cia402Drives, Body]]:
    """Run drives on a bus."""
    body = Body()
    drives = Cia402Drives(body, **bus, **options)
    drives.start()
    try:
        yield drives, body
    finally:
        drives.close()


@contextlib.contextmanager
def pan_tilt(
    settings: dict[str, Any] | None = None, bus: dict[str, Any] | None = None, **options: Any
) -> Iterator[tuple[CanPanTilt, Cia402Drives, Body]]:
    """Open a driver on drives of its own; it is patient, as the machine may be busy."""
    bus = bus or new_bus()
    patience = {
        "max_jerk_deg": 30_000,
        "rate": 100,
        "answer_timeout": 1.0,
        "heartbeat_timeout": 2.0,
        "sdo_timeout": 2.0,
    }
    with drives_on(bus, **options) as (drives, body):
        device = open_pan_tilt({**bus, **patience, **(settings or {})}, body.context())
        try:
            yield device, drives, body
        finally:
            device.close()


def arrives(device: CanPanTilt, pan: float, tilt: float, tolerance: float = 0.01) -> bool:
    """Move and wait until it is settled there."""
    device.move_to(pan, tilt)
    if not eventually(lambda: device.state().settled):
        return False
    state = device.state()
    return math.dist((state.pan, state.tilt), (pan, tilt)) < tolerance
