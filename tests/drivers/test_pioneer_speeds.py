"""Serial ports: finding the speed at which the robot talks, and changing it."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest
from pioneer_robot import context

from drivers.pioneer.codec import CommandNumber as NUMBER
from drivers.pioneer.codec import (
    Config,
    PacketDecoder,
    decode_command,
    encode_config,
    encode_identity,
    encode_sync,
    sync_number,
)
from drivers.pioneer.codec.sync import Identity
from drivers.pioneer.connection import Connection, connect
from drivers.pioneer.settings import PioneerSettings
from zavis_bt.errors import DeviceError

SPEEDS = {0: 9600, 1: 19200, 2: 38400, 3: 57600, 4: 115200}


class SerialRobot:
    """A robot on a serial line: it understands and is understood only at its own speed."""

    is_tcp = False

    def __init__(self, speed: int, autobaud: int = 1, after_change: Callable[[int], int] = lambda new: new) -> None:
        self.speed, self.autobaud, self._after_change = speed, autobaud, after_change
        self.line_speed, self.tried = 0, list[int]()
        self._decoder, self._answer, self._synced = PacketDecoder(), b"", False

    def __call__(self, port: str, *, baud: int, where: str) -> SerialRobot:
        self.set_baud(baud)
        return self

    def set_baud(self, baud: int) -> None:
        self.line_speed = baud
        self.tried.append(baud)

    def read(self, timeout: float = 0.02) -> bytes:
        if not self._answer:
            time.sleep(min(timeout, 0.01))
        answer, self._answer = self._answer, b""
        return answer

    def write(self, data: bytes) -> None:
        if self.line_speed == self.speed:
            for payload in self._decoder.feed(data):
                self._take(payload)
        elif self.line_speed > self.speed:
            self._answer += b"\xf8\x00\x80"

    def close(self) -> None:
        self.line_speed = 0

    def _take(self, payload: bytes) -> None:
        number, command = sync_number(payload), decode_command(payload)
        if not self._synced and number is not None:
            self._synced = number == 2
            self._answer += encode_identity(Identity("r", "Pioneer", "p3dx-sh")) if number == 2 else encode_sync(number)
        elif command.number == NUMBER.CONFIG:
            self._answer += encode_config(Config(subclass="p3dx-sh", autobaud=self.autobaud))
        elif command.number == NUMBER.HOSTBAUD:
            self.speed = self._after_change(SPEEDS[command.integer()])
        elif command.number == NUMBER.PULSE:
            self._answer += encode_sync(0)  # stands for the status packets that come anyway


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drivers.pioneer.handshake._REPLY", 0.03)
    monkeypatch.setattr("drivers.pioneer.handshake._DRAIN", 0.01)
    monkeypatch.setattr("drivers.pioneer.connection._SWITCH_WAIT", 0.05)


def connected(robot: SerialRobot, monkeypatch: pytest.MonkeyPatch, **settings: object) -> Connection:
    monkeypatch.setattr("drivers.pioneer.connection.Link", robot)
    given = PioneerSettings.model_validate({"port": "/dev/ttyUSB0", **settings})
    return connect(given, context().spec.limits, "my.robot.yaml: devices.base", lambda: False)


@pytest.mark.parametrize("speed", SPEEDS.values())
def test_the_robot_is_found_at_whatever_speed_it_talks(speed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = SerialRobot(speed)
    connection = connected(robot, monkeypatch)
    assert connection.baud == robot.line_speed == speed
    assert robot.tried[0] == 9600
    assert connection.parameters.family == "p3dx"


def test_the_speed_of_the_settings_is_tried_first(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = SerialRobot(57600)
    assert connected(robot, monkeypatch, baud=57600).baud == 57600
    assert robot.tried == [57600]


def test_a_robot_that_falls_back_by_itself_is_switched_to_the_faster_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = SerialRobot(9600, autobaud=2)
    assert connected(robot, monkeypatch).baud == robot.line_speed == 38400


def test_the_speed_stays_where_the_robot_cannot_fall_back_or_nobody_wants_it(monkeypatch: pytest.MonkeyPatch) -> None:
    assert connected(SerialRobot(9600, autobaud=1), monkeypatch).baud == 9600
    assert connected(SerialRobot(9600, autobaud=2), monkeypatch, fast_baud=None).baud == 9600
    assert connected(SerialRobot(57600, autobaud=2), monkeypatch).baud == 57600


def test_a_change_of_speed_that_fails_is_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = SerialRobot(9600, autobaud=2, after_change=lambda new: 9600)
    assert connected(robot, monkeypatch).baud == robot.line_speed == 9600


def test_a_robot_lost_at_the_change_of_speed_is_told_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = SerialRobot(9600, autobaud=2, after_change=lambda new: 300)
    with pytest.raises(DeviceError, match="set 'fast_baud' to null"):
        connected(robot, monkeypatch)


def test_garbage_at_every_speed_is_told_from_silence(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(DeviceError, match="not as a Pioneer: bytes f8 00 80"):
        connected(SerialRobot(300), monkeypatch)
    with pytest.raises(DeviceError, match="no answer"):
        connected(SerialRobot(921600), monkeypatch)
