"""The simulated robot's LiDAR behind SCIP 2.0 on TCP."""

from __future__ import annotations

import contextlib
import select
import socket
import threading
import time

from sim.devices.plant import Plant
from sim.devices.scip_eye import Eye
from sim.devices.scip_model import model_of
from sim.devices.scip_sensor import Sensor
from zavis_bt.errors import DeviceError

PORT = 10940
"""Where sensors listen."""
_CHUNK = 4096
_PATIENCE = 16  # chunks that may lie before the end of a host that has gone
_UNPLUGGED = 5000  # [ms] after which a host that takes nothing is given up


class ScipServer:
    """A sensor on the network that serves one host at a time; others are turned away until that one has gone."""

    def __init__(self, plant: Plant, host: str = "127.0.0.1", port: int = 0, *, uptime: float = 0.0) -> None:
        """Listen; nobody is answered until `start`.

        Args:
            plant: The robot, whose ``spec.lidar`` says how the sensor measures.
            host: Address to listen at.
            port: 0 takes any that is free.
            uptime: How long the sensor has been on [s].

        Raises:
            DeviceError: The port cannot be listened at.
        """
        self.parameters = model_of(plant.spec.lidar)
        """What the sensor says of its geometry."""
        try:
            self._listener = socket.create_server((host, port))
        except OSError as error:
            raise DeviceError(
                f"LiDAR: {host}:{port}: cannot listen there: {error.strerror or error} (give another port)"
            ) from error
        self._listener.setblocking(False)
        self.port: int = self._listener.getsockname()[1]
        """Where it listens."""
        self.silent = False
        """Whether all it would say gets lost, while the line stays; set it to see what happens."""
        self._eye = Eye(plant, self.parameters)
        self._sensor = Sensor(self.parameters, self._eye, time.monotonic, uptime)
        self._wake, self._woken = socket.socketpair()
        self._host: socket.socket | None = None
        self._unsent = b""
        self._thread = threading.Thread(target=self._run, name="scip", daemon=True)

    @property
    def clients(self) -> int:
        """Hosts that are connected: none or one."""
        return int(self._host is not None)

    def start(self) -> None:
        """Serve."""
        self._thread.start()

    def close(self) -> None:
        """Break the connection and stop to listen; may be called twice."""
        if self._wake.fileno() >= 0:
            self._wake.close()
            if self._thread.ident is not None:
                self._thread.join()
            self._hang_up()
            self._eye.close()
            self._listener.close()
            self._woken.close()

    def _run(self) -> None:
        while True:
            readers = [self._listener, self._woken, *([self._host] if self._host else [])]
            writers = [self._host] if self._host and self._unsent else []
            due = self._sensor.due
            pause = None if due is None else max(due - time.monotonic(), 0.0)
            readable, writable, _ = select.select(readers, writers, [], pause)
            if self._woken in readable:
                return
            if self._host in readable:
                self._hear()
            if self._listener in readable:
                self._admit()
            if self._host is not None and self._host in writable:
                self._send(b"")
            self._stream()

    def _hear(self) -> None:
        assert self._host is not None
        try:
            data = self._host.recv(_CHUNK)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if data:
            self._send(self._sensor.hear(data))
        else:
            self._hang_up()

    def _stream(self) -> None:
        """Send a scan if it is time; a host that has not taken the last one yet misses it."""
        due = self._sensor.due
        if due is not None and time.monotonic() >= due:
            self._send(self._sensor.scan(send=not self._unsent))

    def _send(self, data: bytes) -> None:
        if self._host is None:
            return
        self._unsent += b"" if self.silent else data
        try:
            self._unsent = self._unsent[self._host.send(self._unsent) :]
        except BlockingIOError:
            pass
        except OSError:
            self._hang_up()

    def _admit(self) -> None:
        """Take a new host, or turn it away if the old one is still there."""
        try:
            visitor, _ = self._listener.accept()
        except OSError:  # it has gone already
            return
        for _ in range(_PATIENCE):
            if self._host is not None and select.select([self._host], [], [], 0)[0]:
                self._hear()
        if self._host is not None:
            visitor.close()
            return
        visitor.setblocking(False)
        with contextlib.suppress(OSError):
            visitor.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            visitor.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _UNPLUGGED)
        self._host = visitor

    def _hang_up(self) -> None:
        if self._host is not None:
            self._host.close()
        self._host, self._unsent = None, b""
        self._sensor.hang_up()
