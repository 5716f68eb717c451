"""The mission's end of the browser view: starts the server process, talks to it without ever waiting, and ends it."""

from __future__ import annotations

import atexit
import contextlib
import json
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from zavis_bt.errors import DeviceError

_START_TIMEOUT, _STOP_TIMEOUT = 20.0, 2.0  # [s]


class Message(NamedTuple):
    """News for the scene."""

    name: str
    """``path#slot``: takes the place of an older message of that name."""
    payload: bytes


class Link:
    """A server process and two threads that write to it and read from it."""

    def __init__(self, host: str = "127.0.0.1", port: int | None = None) -> None:
        """Start the server.

        Args:
            host: Address to listen at.
            port: None takes the first free one from 7000, 0 any.

        Raises:
            DeviceError: It does not start, for example because the port is taken.
        """
        self.browsers = 0
        self._closed = False
        self._outbox: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._idle = threading.Event()
        self._idle.set()
        self._address: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._process, self._complaints = _start(host, port)
        atexit.register(self.close)
        self._threads = [threading.Thread(target=work, daemon=True) for work in (self._read, self._write)]
        for thread in self._threads:
            thread.start()
        self.url = self._wait_for_address(host, port)

    @property
    def alive(self) -> bool:
        """Whether the server runs."""
        return self._process.poll() is None

    @property
    def busy(self) -> bool:
        """Whether the last batch is still being handed over."""
        return not self._idle.is_set()

    def send(self, batch: Sequence[Message]) -> None:
        """Hand over a batch; dropped if the last one is still under way, so ask `busy` first."""
        # The server's header, written here so that this process need not import the server's libraries.
        parts = [
            piece
            for message in batch
            for name in [message.name.encode()]
            for piece in (len(name).to_bytes(4, "big"), len(message.payload).to_bytes(4, "big"), name, message.payload)
        ]
        if parts and not self.busy and not self._closed:
            self._idle.clear()
            self._outbox.put(b"".join(parts))

    def flush(self, timeout: float) -> bool:
        """Wait until the last batch was handed over; returns whether it was."""
        return self._idle.wait(timeout)

    def close(self) -> None:
        """End the server; may be called twice."""
        atexit.unregister(self.close)
        if self._closed:
            return
        self._closed = True
        self._outbox.put(None)  # ends the server's input, at which it sends what is left and ends, too
        try:
            self._process.wait(_STOP_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for thread in self._threads:
            thread.join(_STOP_TIMEOUT)
        for pipe in (self._process.stdin, self._process.stdout, self._complaints):
            if pipe is not None:
                with contextlib.suppress(OSError):  # unwritten bytes for a server that is gone
                    pipe.close()

    def _wait_for_address(self, host: str, port: int | None) -> str:
        try:
            url = self._address.get(timeout=_START_TIMEOUT)
        except queue.Empty:
            url = None
        if url is None:
            said = self._complaints_of_server()
            where = f"{host}:{port}" if port else host
            reason = said[-1] if said else f"does not answer within {_START_TIMEOUT:g} s"
            raise DeviceError(f"browser view at {where}: {reason} (another port would be right if this one is taken)")
        return url

    def _complaints_of_server(self) -> list[str]:
        self._process.kill()
        self._process.wait()
        self._complaints.seek(0)
        said = self._complaints.read().decode(errors="replace").strip().splitlines()
        self.close()
        return said

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            news = json.loads(line)
            if "url" in news:
                self._address.put(news["url"])
            self.browsers = news.get("browsers", self.browsers)
        self._address.put(None)

    def _write(self) -> None:
        assert self._process.stdin is not None
        while (data := self._outbox.get()) is not None:
            with contextlib.suppress(OSError):  # the server is gone; `alive` says so
                self._process.stdin.write(data)
                self._process.stdin.flush()
            self._idle.set()
        with contextlib.suppress(OSError):
            self._process.stdin.close()


def _start(host: str, port: int | None) -> tuple[subprocess.Popen[bytes], tempfile._TemporaryFileWrapper[bytes]]:
    # As a file, without this package: the server needs a third of the memory and time then.
    command = [sys.executable, "-P", str(Path(__file__).with_name("server.py")), "--host", host]
    if port is not None:
        command += ["--port", str(port)]
    complaints = tempfile.NamedTemporaryFile()  # noqa: SIM115 - lives as long as the process
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=complaints,
        start_new_session=True,  # Ctrl-C in the terminal is for the mission, which ends the server in its turn
    )
    return process, complaints
