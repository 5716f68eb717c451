"""A hall with a robot and its simulated LiDAR, and sensors on a serial line, for tests of the driver."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import os
import pty
import select
import threading
import time
import tty
from collections.abc import Callable, Iterator

import numpy as np

from drivers.lidar import ScipLidar, open_lidar
from drivers.lidar.codec import Parameters
from drivers.profiles import builtin_robot
from sim.devices.plant import Plant
from sim.devices.scip import ScipServer
from sim.devices.scip_eye import Eye
from sim.devices.scip_model import model_of
from sim.devices.scip_sensor import Sensor
from sim.world import World
from zavis_bt.mission.clock import WallClock
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import FREE, OCCUPIED, FloatArray, GridMap, LidarSpec, Pose2D, RobotSpec

PATIENCE = 20.0  # a loaded machine may take long [s]
START = Pose2D(2.0, 1.5, 0.3)
PIONEER = load_robot(builtin_robot("pioneer3at")).spec


def hall() -> World:
    """12 m × 5 m, so that a LiDAR of 10 m does not see all walls; two pillars."""
    cells = np.pad(np.zeros((100, 240), dtype=np.bool_), 2, constant_values=True)
    cells[40:46, 120:130] = cells[80:90, 20:30] = True
    return World("hall", GridMap(np.where(cells, OCCUPIED, FREE).astype(np.int8), 0.05, (-0.1, -0.1)), 2.5)


def robot(**lidar: float) -> RobotSpec:
    """A Pioneer with another LiDAR."""
    return dataclasses.replace(PIONEER, lidar=dataclasses.replace(PIONEER.lidar, **lidar))


def around(degrees: float, beams: int) -> dict[str, float]:
    return {"beams": beams, "field_of_view": math.radians(degrees)}


@contextlib.contextmanager
def served(spec: RobotSpec = PIONEER, *, uptime: float = 0.0) -> Iterator[ScipServer]:
    plant = Plant(hall(), spec, START)
    server = ScipServer(plant, uptime=uptime)
    plant.start()
    server.start()
    try:
        yield server
    finally:
        server.close()
        plant.close()


def address(port: int) -> str:
    return f"tcp://127.0.0.1:{port}"


def context(spec: RobotSpec = PIONEER) -> DeviceContext:
    def camera_pose(stamp: float) -> FloatArray:
        return np.eye(4)

    return DeviceContext("my.robot.yaml: devices.lidar", spec, WallClock(), START, camera_pose)


@contextlib.contextmanager
def opened(port: str, told: DeviceContext | None = None, **settings: object) -> Iterator[ScipLidar]:
    lidar = open_lidar({"port": port, **settings}, told or context())
    try:
        yield lidar
    finally:
        lidar.close()


def wait_for(condition: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "it did not come about"
        time.sleep(0.005)


class SerialSensor:
    """A sensor on a pseudo-terminal; one of the old kind begins in the protocol's first version."""

    def __init__(self, lidar: LidarSpec = PIONEER.lidar, *, old: bool = False) -> None:
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._plant = Plant(hall(), dataclasses.replace(PIONEER, lidar=lidar), START)
        parameters: Parameters = model_of(lidar)
        self._sensor = Sensor(parameters, Eye(self._plant, parameters), time.monotonic)
        self._deaf = old
        self.heard = b""
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> SerialSensor:
        self._plant.start()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._running = False
        self._thread.join()
        self._plant.close()
        os.close(self._master)
        os.close(self._slave)

    def _run(self) -> None:
        while self._running:
            due = self._sensor.due
            pause = 0.02 if due is None else min(max(due - time.monotonic(), 0.0), 0.02)
            if select.select([self._master], [], [], pause)[0]:
                os.write(self._master, self._reply(os.read(self._master, 4096)))
            due = self._sensor.due
            if due is not None and time.monotonic() >= due:
                os.write(self._master, self._sensor.scan())

    def _reply(self, data: bytes) -> bytes:
        self.heard += data
        if not self._deaf:
            return self._sensor.hear(data)
        if b"SCIP2.0\n" not in data:
            return data.replace(b"\n", b"\n?\n\n")
        self._deaf = False
        return b"SCIP2.0\n0\n\n"
