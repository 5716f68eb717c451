"""The pan-tilt driver: ruckig's set-points and the beat of the cycle: ``python -m benchmarks.pan_tilt``.

The cycle is timed while both axes move, with the simulated drives in the same process: they take part of the machine.
"""

from __future__ import annotations

import math
import random
import time
import uuid
from types import SimpleNamespace
from typing import Any

import numpy as np

from benchmarks.timing import machine, verdict
from drivers.pan_tilt import open_pan_tilt
from drivers.pan_tilt.pace import quantile
from drivers.pan_tilt.trajectory import Trajectory
from sim.devices.cia402 import Cia402Drives
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import PanTiltSpec, Pose2D

SPEC = PanTiltSpec(-2.7, 2.7, -0.8, 0.5, math.radians(90), math.radians(180))
UPDATES = 20_000
JITTER = 5e-3


def updates_a_second(new_targets: bool) -> float:
    trajectory = Trajectory(SPEC, SPEC.max_acceleration / 0.1, 0.02)
    targets = [((step % 11 - 5) * 0.4, (step % 7 - 4) * 0.1) for step in range(77)]
    begin = time.process_time()
    for step in range(UPDATES):
        if new_targets or trajectory.done:
            trajectory.go_to(targets[step % 77])
        trajectory.step()
    return UPDATES / (time.process_time() - begin)


def cycles(bus: dict[str, Any], seconds: float) -> None:
    body: Any = SimpleNamespace(spec=SimpleNamespace(pan_tilt=SPEC), now=0.0, joints=None)
    clock: Any = SimpleNamespace(now=time.monotonic)
    drives = Cia402Drives(body, **bus)
    drives.start()
    device = open_pan_tilt(bus, DeviceContext("bench", body.spec, clock, Pose2D(0, 0), lambda stamp: np.eye(4)))
    try:
        end, pan = time.monotonic() + seconds, 1.0
        while time.monotonic() < end:
            device.move_to(pan, pan / 3)
            pan = -pan
            time.sleep(1.2)
        pace, latencies = device._unit.pace, device._unit.latencies
        late, usual = pace.lateness(0.99), pace.lateness(0.5)
        answers = [quantile(latencies, share) * 1e3 for share in (0.5, 0.99)]
        print(
            f"{bus['interface']:<14} 50 Hz, late by {usual * 1e3:.2f} ms (median), {late * 1e3:.2f} ms (99 %), "
            f"{pace.lost} lost, {device._faults} faults: {verdict(late < JITTER and not device._faults)}; "
            f"SYNC to both measurements {answers[0]:.2f} ms (median), {answers[1]:.2f} ms (99 %)"
        )
    finally:
        device.close()
        drives.close()


def main() -> None:
    print(machine())
    for name, new_targets in (("on the way", False), ("a new target each time", True)):
        rate = updates_a_second(new_targets)
        print(f"two-axis set-points, {name}: {rate:,.0f} a second: {verdict(rate >= UPDATES)}")
    cycles({"interface": "virtual", "channel": uuid.uuid4().hex}, 12)
    group = f"239.{random.randrange(1, 255)}.{random.randrange(256)}.{random.randrange(1, 255)}"
    cycles({"interface": "udp_multicast", "channel": group}, 12)


if __name__ == "__main__":
    main()
