"""A simulated Pioneer to test: in lock step without any line, and a bare client for its lines."""

from __future__ import annotations

import itertools
import math
import select
import socket
import time
from collections.abc import Callable, Iterator

import numpy as np

from drivers.pioneer.codec import (
    CommandNumber,
    PacketDecoder,
    Sip,
    decode_sip,
    encode,
    encode_command,
    encode_sync,
    is_sip,
)
from sim.devices.arcos import P3AT, Firmware, PioneerModel, Reply
from sim.devices.plant import Plant
from sim.kinematics import Motion
from sim.world import World
from zavis_bt.types import (
    FREE,
    OCCUPIED,
    BaseLimits,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    GridMap,
    LidarSpec,
    PanTiltSpec,
    Pose2D,
    RobotSpec,
)

STEP = 0.02
DEADLINE = 20.0  # a loaded machine may be slow [s]

PIONEER = RobotSpec(
    "pioneer",
    Footprint(0.508, 0.497),
    BaseLimits(0.7, 0.4, 2.4, 0.3, 1.7),
    LidarSpec(181, math.pi, 0.05, 10.0, 10.0, Pose2D(0.16, 0.0), 0.38),
    PanTiltSpec(-2.7, 2.7, -0.8, 0.5, 1.5, 3.0),
    CameraSpec(CameraIntrinsics.from_fov(64, 48, math.pi / 3), 0.06, 1.1, 0.3, 10.0, 10.0),
)


class Bench:
    """A robot in lock step: bytes are handed to the firmware, and time passes when told."""

    def __init__(
        self,
        world: World,
        start: Pose2D | None = None,
        *,
        watchdog: float = 1.0,
        model: PioneerModel = P3AT,
        connected: bool = True,
        motors: bool = True,
    ) -> None:
        self.plant = Plant(world, PIONEER, start or Pose2D(1.0, 2.0))
        self.firmware = Firmware(self.plant, model, watchdog=watchdog)
        if connected:
            self.connect()
        if connected and motors:
            self.send(CommandNumber.ENABLE, 1)

    def connect(self) -> None:
        for number in range(3):
            self.packet(encode_sync(number))
        self.send(CommandNumber.OPEN, 1)

    def packet(self, packet: bytes) -> Reply:
        (payload,) = PacketDecoder().feed(packet)
        return self.firmware.receive(payload)

    def send(self, number: int, argument: int | bytes | None = None) -> Reply:
        return self.packet(encode_command(number, argument))

    def run(self, seconds: float, *, pulse: bool = True) -> list[Motion]:
        """Let time pass with a PULSE now and then, and return the motion after each step."""
        motions = []
        for step in range(round(seconds / STEP)):
            if pulse and step % 10 == 0:
                self.send(CommandNumber.PULSE)
            self.plant.step()
            motions.append(self.plant.motion)
        return motions

    def packets(self) -> list[bytes]:
        """What the robot reports now."""
        return PacketDecoder().feed(self.firmware.report())

    def sip(self) -> Sip:
        return decode_sip(self.packets()[0])


def changes(motions: list[Motion], attribute: str) -> list[float]:
    """Accelerations from step to step."""
    values = [getattr(motion, attribute) for motion in motions]
    return [(after - before) / STEP for before, after in itertools.pairwise(values)]


class Client:
    """The least a client must do, over a socket or a file descriptor."""

    def __init__(self, fd: int, write: Callable[[bytes], object], read: Callable[[int], bytes]) -> None:
        self._fd, self.write, self._read = fd, write, read
        self.decoder = PacketDecoder()
        self._waiting: list[bytes] = []

    def send(self, number: int, argument: int | bytes | None = None) -> None:
        self.write(encode_command(number, argument))

    def packets(self, deadline: float = DEADLINE) -> Iterator[bytes]:
        """Packets as they come, with a PULSE now and then."""
        end = time.monotonic() + deadline
        while time.monotonic() < end:
            while self._waiting:
                yield self._waiting.pop(0)
            if select.select([self._fd], [], [], 0.3)[0]:
                data = self._read(4096)
                if not data:
                    raise EOFError
                self._waiting += self.decoder.feed(data)
        raise AssertionError("nothing of the kind came")

    def next(self, deadline: float = DEADLINE) -> bytes:
        return next(self.packets(deadline))

    def quiet(self, seconds: float) -> bool:
        """Whether nothing comes for so long."""
        return not self._waiting and not select.select([self._fd], [], [], seconds)[0]

    def synchronise(self) -> list[bytes]:
        replies = []
        for number in range(3):
            self.write(encode_sync(number))
            replies.append(self.next())
        return replies

    def connect(self) -> None:
        self.synchronise()
        self.send(CommandNumber.OPEN, 1)
        self.sip()

    def sip(self, wanted: Callable[[Sip], bool] = lambda sip: True, *, pulse: bool = True) -> Sip:
        """The next SIP that is as wanted."""
        for payload in self.packets():
            if pulse:
                self.send(CommandNumber.PULSE)
            if is_sip(payload) and wanted(sip := decode_sip(payload)):
                return sip
        raise AssertionError


class TcpClient(Client):
    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=DEADLINE)
        super().__init__(self.socket.fileno(), self.socket.sendall, self.socket.recv)

    def __enter__(self) -> TcpClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()


def wait_for(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + DEADLINE
    while not condition():
        assert time.monotonic() < end, "it never came to be so"
        time.sleep(0.01)


def raw(*payload: int) -> bytes:
    return encode(bytes(payload))


def broken(packet: bytes) -> bytes:
    """The packet with a wrong checksum."""
    return packet[:-1] + bytes((packet[-1] ^ 1,))


def hall() -> World:
    """40 m by 40 m of free floor."""
    states = np.full((400, 400), FREE, dtype=np.int8)
    states[0], states[-1], states[:, 0], states[:, -1] = (OCCUPIED,) * 4
    return World("hall", GridMap(states, 0.1, (-20.0, -20.0)), 2.5)


HALL = hall()
CENTRE = Pose2D(0.0, 0.0)


def drive(client: Client, speed: int = 600) -> None:
    """Set a connected robot going."""
    client.send(CommandNumber.SETA, 4000)
    client.send(CommandNumber.SETA, -4000)
    client.send(CommandNumber.ENABLE, 1)
    client.send(CommandNumber.VEL, speed)
    client.sip(lambda sip: sip.left_velocity > 100)
