"""ARCOS over TCP, as simulators and Ethernet bridges offer it."""

from __future__ import annotations

import contextlib
import select
import socket
import threading

from sim.devices.arcos.firmware import Firmware
from sim.devices.arcos.model import P3AT, PioneerModel
from sim.devices.arcos.session import Session
from sim.devices.plant import Plant
from zavis_bt.errors import DeviceError

_CHUNK = 4096
_RETRY = 0.2  # [s]
_STUCK = 1.0  # a client that takes nothing for so long is gone [s]
_UNPLUGGED_MS = 3000  # and so is one whose computer acknowledges nothing for so long


class ArcosServer:
    """Serves one client at a time; while one is connected nobody listens, so that others are refused."""

    def __init__(
        self,
        plant: Plant,
        *,
        host: str = "127.0.0.1",
        port: int = 8101,
        watchdog: float = 1.0,
        model: PioneerModel = P3AT,
        firmware: Firmware | None = None,
    ) -> None:
        """Listen; clients are served from `start` on.

        Args:
            plant: The robot's body.
            host: Address to listen at.
            port: 0 for any free one, which is then in `port`.
            watchdog: Silence of a client after which the robot stops [s]; 0 = never.
            model: What kind of Pioneer it is.
            firmware: That of another line to the same robot; watchdog and model are its own then.

        Raises:
            DeviceError: The port cannot be had.
        """
        self.firmware = firmware or Firmware(plant, model, watchdog=watchdog)
        self.present = True
        self._host, self.port = host, port
        self._active = self._listen()
        self.port = self._active.getsockname()[1]
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="arcos-tcp", daemon=True)

    def start(self) -> None:
        """Serve clients."""
        self._thread.start()

    def close(self) -> None:
        """End the connection and stop listening; may be called twice."""
        self._closing.set()
        with contextlib.suppress(OSError):
            self._active.shutdown(socket.SHUT_RDWR)
        if self._thread.is_alive():
            self._thread.join()
        self._active.close()

    def _run(self) -> None:
        while not self._closing.is_set():
            client = self._accept()
            if client is None:
                continue
            if not self.firmware.claim(self):
                client.close()
                continue
            listener, self._active = self._active, client
            listener.close()
            try:
                self._serve(client)
            except OSError:
                pass  # the client is gone, which is the same as its end
            finally:
                self.firmware.release(self)
                self._listen_again()
                client.close()

    def _accept(self) -> socket.socket | None:
        try:
            client, _ = self._active.accept()
        except OSError:  # nobody came for a while, or close() was called
            return None
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _UNPLUGGED_MS)
        client.settimeout(_STUCK)
        return client

    def _serve(self, client: socket.socket) -> None:
        session = Session(self.firmware)
        poll = select.poll()
        poll.register(client, select.POLLIN)
        while not self._closing.is_set():
            data = b""
            if poll.poll(session.wait * 1000):
                data = client.recv(_CHUNK)
                if not data:
                    return
            reply = session.take(session.payloads(data))
            if packets := reply.packets or session.report():
                client.sendall(packets)
            if reply.closed:
                return

    def _listen(self) -> socket.socket:
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind((self._host, self.port))
            listener.listen(1)
        except OSError as error:
            listener.close()
            why = "another program uses the port, or the address is not this computer's"
            raise DeviceError(f"{self._host}:{self.port}: cannot be listened at ({why}): {error.strerror}") from error
        listener.settimeout(_RETRY)
        return listener

    def _listen_again(self) -> None:
        """Listen as before the client came: before its socket is closed, which keeps the port taken."""
        while not self._closing.is_set():
            try:
                self._active = self._listen()
            except DeviceError:
                self._closing.wait(_RETRY)
            else:
                return
