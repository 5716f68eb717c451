"""A host of a simulated LiDAR that speaks in plain bytes, and a sensor in lock step, for tests."""

from __future__ import annotations

import socket
import time
from types import TracebackType

import numpy as np

from drivers.lidar.codec import Answer, AnswerDecoder, Parameters
from sim.devices.plant import Plant
from sim.devices.scip_eye import Eye
from sim.devices.scip_model import model_of
from sim.devices.scip_sensor import Sensor
from sim.world import World
from zavis_bt.types import Pose2D, RobotSpec

PATIENCE = 20.0  # a loaded machine may take long [s]
START = Pose2D(1.0, 1.0, 0.4)


class StillSensor:
    """A sensor whose time passes when told, on a robot that stands still."""

    def __init__(self, world: World, spec: RobotSpec) -> None:
        self.plant = Plant(world, spec, START)
        self.parameters: Parameters = model_of(spec.lidar)
        self.now = 1000.0
        self.sensor = Sensor(self.parameters, Eye(self.plant, self.parameters, lambda: self.now), lambda: self.now)

    def say(self, *requests: bytes) -> bytes:
        return self.sensor.hear(b"".join(request + b"\n" for request in requests))

    def ask(self, request: bytes) -> Answer:
        (answer,) = AnswerDecoder().feed(self.say(request))
        assert answer.echo == request
        return answer

    def turn(self, turns: int = 1) -> list[bytes]:
        """What the stream sends in so many turns."""
        sent, end = [], self.now + turns * 60 / self.parameters.scan
        while (due := self.sensor.due) is not None and due <= end + 1e-6:
            self.now = due
            sent.append(self.sensor.scan())
        self.now = end
        return sent


class Host:
    """A host on TCP."""

    def __init__(self, port: int) -> None:
        self.line = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
        self.decoder = AnswerDecoder()
        self.read = b""

    def __enter__(self) -> Host:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.line.close()

    def say(self, text: bytes) -> None:
        self.line.sendall(text)

    def expect(self, text: bytes) -> None:
        """Read until exactly this has come."""
        while len(self.read) < len(text):
            self.read += self.line.recv(len(text) - len(self.read))
        assert self.read == text
        self.read = b""

    def scans(self, count: int) -> list[np.ndarray]:
        found: list[np.ndarray] = []
        end = time.monotonic() + PATIENCE
        while len(found) < count:
            assert time.monotonic() < end
            answers = self.decoder.feed(self.line.recv(65536))
            found += [answer.readings.ranges for answer in answers if answer.readings is not None]
        return found

    def until(self, text: bytes) -> bytes:
        """What comes up to and with this text."""
        data = b""
        while not data.endswith(text):
            data += self.line.recv(1)
        return data
