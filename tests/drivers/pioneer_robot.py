"""A robot at the other end of the line for tests: it answers as told and writes down what it hears."""

from __future__ import annotations

import contextlib
import select
import socket
import threading
import time
from collections.abc import Callable, Iterator
from types import TracebackType

from drivers.pioneer import PioneerBase, open_base
from drivers.pioneer.codec import (
    Command,
    CommandNumber,
    Config,
    Encoders,
    Flags,
    Identity,
    PacketDecoder,
    Sip,
    decode_command,
    encode_config,
    encode_encoders,
    encode_identity,
    encode_sip,
    encode_sync,
    sync_number,
)
from drivers.profiles import builtin_robot
from zavis_bt.mission.clock import WallClock
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import FloatArray, Pose2D

NUMBER = CommandNumber
PATIENCE = 10.0  # a loaded machine may take long [s]


class ScriptedRobot:
    """Serves one client after the other on a TCP port of its own."""

    def __init__(self, *, period: float = 0.02, config: Config | None = None, subclass: str = "p3at-sh") -> None:
        self.identity = Identity("tester", "Pioneer", subclass)
        self.config: Config | None = config or Config(subclass=subclass, watchdog=1000, serial_number="S1")
        self.sip = Sip(battery=125, battery_x10=125)
        self.encoders: Encoders | None = None
        """Sent with every SIP, if the client has asked for it."""
        self.period = period
        self.heard: list[tuple[float, Command]] = []
        """Commands since the start with their times; SYNCs are not among them."""
        self.syncs: list[int] = []
        self.sends = True
        self.deaf_to: set[int] = set()
        """Commands without effect."""
        self.sync_reply: Callable[[int], bytes | None] = self.usual_reply
        self.refuses = False
        """Whether new connections are closed at once."""
        self.ends_on_close = True
        self.connections = 0
        self.opened = False
        self._synced = False
        self._noise = b""
        self._cut, self._gone = threading.Event(), threading.Event()
        self._ending = threading.Event()
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = self._server.getsockname()[1]
        self._thread = threading.Thread(target=self._run, name="scripted robot", daemon=True)
        self._thread.start()

    def __enter__(self) -> ScriptedRobot:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._ending.set()
        self._thread.join()
        self._server.close()

    @property
    def url(self) -> str:
        return f"tcp://127.0.0.1:{self.port}"

    def cut(self) -> None:
        """Close the connection from this end; nothing is sent on it any more."""
        self._gone.clear()
        self._cut.set()
        assert self._gone.wait(PATIENCE)

    def add_noise(self, noise: bytes) -> None:
        """Send these bytes before the next SIP."""
        self._noise = noise

    def numbers(self) -> list[int]:
        return [command.number for _, command in self.heard]

    def velocities(self) -> list[tuple[float, int]]:
        """Times and values of all VEL and RVEL other than zero."""
        moving = (NUMBER.VEL, NUMBER.RVEL)
        return [(at, command.integer()) for at, command in self.heard if command.number in moving and command.integer()]

    def usual_reply(self, number: int) -> bytes:
        return encode_identity(self.identity) if number == 2 else encode_sync(number)

    def _run(self) -> None:
        while not self._ending.is_set():
            if not select.select([self._server], [], [], 0.02)[0]:
                continue
            line, _ = self._server.accept()
            self.connections += 1
            with line, contextlib.suppress(OSError):
                if not self.refuses:
                    self._serve(line)
            self._gone.set()

    def _serve(self, line: socket.socket) -> None:
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._cut.clear()
        self.opened, self._synced, decoder, due = False, False, PacketDecoder(), 0.0
        self.sip = self.sip._replace(flags=self.sip.flags & ~Flags.MOTORS_ENABLED)
        while not self._ending.is_set() and not self._cut.is_set():
            if select.select([line], [], [], 0.005)[0]:
                data = line.recv(4096)
                if not data:
                    return
                for payload in decoder.feed(data):
                    number = sync_number(payload)
                    if number is not None and not self._synced:
                        self._synced = self._answer_sync(line, number)
                    elif not self._obey(line, decode_command(payload)):
                        return
            if self.opened and self.sends and time.monotonic() >= due:
                due = time.monotonic() + self.period
                noise, self._noise = self._noise, b""
                line.sendall(noise + encode_sip(self.sip))
                if self.encoders and NUMBER.ENCODER in self.numbers():
                    line.sendall(encode_encoders(self.encoders))

    def _answer_sync(self, line: socket.socket, number: int) -> bool:
        self.syncs.append(number)
        reply = self.sync_reply(number)
        if reply:
            line.sendall(reply)
        return number == 2 and reply is not None

    def _obey(self, line: socket.socket, command: Command) -> bool:
        self.heard.append((time.monotonic(), command))
        if command.number in self.deaf_to or not (self._synced or command.number == NUMBER.CLOSE):
            return True
        if command.number == NUMBER.OPEN:
            self.opened = True
        elif command.number == NUMBER.CONFIG and self.config:
            line.sendall(encode_config(self.config))
        elif command.number == NUMBER.ENABLE:
            off = self.sip.flags & ~Flags.MOTORS_ENABLED
            self.sip = self.sip._replace(flags=off | (Flags.MOTORS_ENABLED if command.integer() else 0))
        elif command.number == NUMBER.CLOSE:
            self.opened = self._synced = False
            return not self.ends_on_close
        return True


def context(start: Pose2D | None = None) -> DeviceContext:
    def nowhere(stamp: float) -> FloatArray:
        raise AssertionError("a base has no camera")

    spec = load_robot(builtin_robot("pioneer3at")).spec
    return DeviceContext("my.robot.yaml: devices.base", spec, WallClock(), start or Pose2D(0.0, 0.0), nowhere)


@contextlib.contextmanager
def opened(robot: ScriptedRobot, start: Pose2D | None = None, **settings: object) -> Iterator[PioneerBase]:
    """Open the driver on a robot, and close it afterwards."""
    base = open_base({"port": robot.url, **settings}, context(start))
    try:
        yield base
    finally:
        base.close()


def wait_for(condition: Callable[[], object], seconds: float = PATIENCE) -> bool:
    """Return whether the condition came true in time."""
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.005)
    return True
