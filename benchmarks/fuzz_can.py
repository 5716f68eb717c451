"""Random and mutated CAN frames between the pan-tilt driver and the two simulated drives, while both are at work."""

from __future__ import annotations

import contextlib
import gc
import logging
import threading
import time
import tracemalloc
import uuid
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.fuzz_result import Result
from drivers import builtin_robot
from drivers.pan_tilt import open_pan_tilt
from sim.devices.cia402 import Cia402Drives
from zavis_bt.mission.clock import WallClock
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import PanTiltState, Pose2D, RobotSpec

_FROM_DRIVES = (0x080, 0x180, 0x280, 0x380, 0x480, 0x580, 0x700)
_FROM_MASTER = (0x200, 0x300, 0x400, 0x500, 0x600)
_TO_ALL = (0x000, 0x080, 0x77F)
_OBJECTS = (0x1000, 0x1016, 0x1017, 0x1400, 0x1600, 0x1A00, 0x6040, 0x6060, 0x607A, 0x607D, 0x6081, 0x6083, 0x60C2)
_SDO_COMMANDS = (0x21, 0x22, 0x23, 0x27, 0x2B, 0x2F, 0x40, 0x43, 0x4B, 0x4F, 0x60, 0x70, 0x80, 0xA0, 0xC0)
_BURST = 40  # frames, then a pause in which they are taken
_PAUSE = 0.004  # [s]
_HISTORIES = 200_000  # times and angles of the last cycles that the driver remembers [bytes]
_WELL_WITHIN = 20.0  # [s]


@dataclass
class Body:
    """What the unit sits on."""

    spec: RobotSpec
    begun: float

    def joints(self, stamp: float) -> tuple[float, float]:
        return 0.0, 0.0

    @property
    def now(self) -> float:
        return time.monotonic() - self.begun


def frame(rng: np.random.Generator, services: tuple[int, ...]) -> tuple[int, bytes]:
    """Return identifier and data of nonsense that passes for a frame of one side."""
    data = bytearray(rng.bytes(int(rng.integers(0, 9))))
    identifier = int(rng.choice(services)) + int(rng.integers(1, 3))
    if rng.random() < 0.1:
        identifier = int(rng.choice(_TO_ALL if services is _FROM_MASTER else services))
    elif rng.random() < 0.1:
        identifier = int(rng.integers(0x800))
    if identifier & 0x780 in (0x580, 0x600) and len(data) >= 4 and rng.random() < 0.8:
        data[0] = int(rng.choice(_SDO_COMMANDS))
        data[1:3] = int(rng.choice(_OBJECTS)).to_bytes(2, "little")
        data[3] %= 4
        data = data.ljust(8, b"\0") if rng.random() < 0.8 else data
    return identifier, bytes(data)


@contextlib.contextmanager
def failures() -> Iterator[list[str]]:
    """Collect what escapes in any thread, and keep canopen's log quiet."""
    found: list[str] = []
    usual = threading.excepthook
    threading.excepthook = lambda args: found.append(f"{args.exc_type.__name__}: {args.exc_value}")
    logging.disable(logging.CRITICAL)
    try:
        yield found
    finally:
        threading.excepthook = usual
        logging.disable(logging.NOTSET)


def fuzz_can(side: str, size: int, seed: int) -> Result:
    """Put ``size`` bytes of nonsense on the bus, as if the ``driver`` or the ``drives`` were to take it."""
    import can

    rng, result, first = np.random.default_rng([seed, len(side)]), Result(kept=_HISTORIES), 0
    services = _FROM_DRIVES if side == "driver" else _FROM_MASTER
    spec, clock, channel = load_robot(builtin_robot("pioneer3at")).spec, WallClock(), uuid.uuid4().hex
    context = DeviceContext("fuzz", spec, clock, Pose2D(0.0, 0.0), lambda stamp: np.eye(4))
    drives = Cia402Drives(Body(spec, time.monotonic()), interface="virtual", channel=channel)
    with failures() as found, contextlib.ExitStack() as stack:
        drives.start()
        stack.callback(drives.close)
        unit = open_pan_tilt({"interface": "virtual", "channel": channel}, context)
        stack.callback(unit.close)
        bus = stack.enter_context(can.Bus(interface="virtual", channel=channel, receive_own_messages=False))
        while result.eaten < size and not found:
            for _ in range(_BURST):
                identifier, data = frame(rng, services)
                bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))
                result.eaten += len(data) + 2
            while bus.recv(0) is not None:  # what the others send is not wanted, and must not pile up
                pass
            time.sleep(_PAUSE)
            if rng.random() < 0.002 or (not first and result.eaten > size / 2):
                result.recoveries += 1
                result.error = _recover(drives, unit, restart=side == "drives")
                if result.error:
                    break
            if not first and result.eaten > size / 2:
                gc.collect()
                tracemalloc.start()
                first = tracemalloc.get_traced_memory()[0]
        result.error = result.error or _recover(drives, unit, restart=side == "drives") or "; ".join(found[:1])
        gc.collect()
        if tracemalloc.is_tracing():
            last, result.peak = tracemalloc.get_traced_memory()
            result.growth = last - first
            tracemalloc.stop()
    return result


def _recover(drives: Cia402Drives, unit, *, restart: bool) -> str:
    """Leave the bus in peace until a move succeeds; return what is wrong if that never happens."""
    if restart:  # nonsense may have been written to any object, which only a restart undoes
        for axis in drives.nodes:
            drives.restart(axis)
    end, asked = time.monotonic() + _WELL_WITHIN, None
    while time.monotonic() < end:
        state: PanTiltState = unit.state()
        if not state.fault and asked is None:
            asked = 0.05 if state.pan < 0 else -0.05
            with contextlib.suppress(Exception):  # it may have failed in this moment: then once more
                unit.move_to(asked, 0.0)
        if state.fault:
            asked = None
        elif asked is not None and state.settled and abs(state.pan - asked) < 0.01:
            return ""
        time.sleep(0.01)
    return f"not well after {_WELL_WITHIN:g} s: {unit.state()}"
