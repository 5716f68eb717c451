"""A line of bytes to a device: serial port or TCP, with failures in plain words."""

from __future__ import annotations

import contextlib
import errno
import os
import select
import socket
from typing import Any

from zavis_bt.errors import DeviceError

_CHUNK = 4096
_WRITE_TIMEOUT = 0.5  # a line that takes nothing for so long is broken [s]


class Link:
    """Bytes to and from a device, through pyserial. One thread reads; writers take turns by themselves."""

    def __init__(self, port: str, *, baud: int, where: str) -> None:
        """Open the line.

        Args:
            port: ``/dev/ttyUSB0``, ``tcp://host:port``, or any other URL that pyserial knows and that has a file
                descriptor.
            baud: Speed of a serial port; means nothing to TCP.
            where: Place in the robot file, to begin error messages with.

        Raises:
            DeviceError: It cannot be opened: one line with the remedy.
        """
        import serial

        self.port, self._where = port, where
        self.is_tcp = port.startswith(("tcp://", "socket://"))
        url = port.replace("tcp://", "socket://", 1)
        try:
            self._serial: Any = serial.serial_for_url(url, baudrate=baud, timeout=0, write_timeout=_WRITE_TIMEOUT)
            self._fd: int = self._serial.fileno()
        except (
            OSError,
            ValueError,
        ) as error:  # ValueError: a URL or speed it cannot use
            raise DeviceError(f"{where}: {port}: {_plain(error)}") from error
        if self.is_tcp:
            _send_at_once(self._fd)

    def read(self, timeout: float = 0.02, size: int = _CHUNK) -> bytes:
        """Return what has arrived, up to ``size`` bytes; nothing if nothing comes within ``timeout`` [s].

        Raises:
            DeviceError: The line is broken, or the other end has closed it.
        """
        try:
            if not select.select([self._fd], [], [], timeout)[0]:
                return b""
            data = os.read(self._fd, size)
        except (OSError, ValueError) as error:
            raise DeviceError(f"{self._where}: {self.port}: {_plain(error)}") from error
        if not data:
            raise DeviceError(f"{self._where}: {self.port}: the other end has closed the connection")
        return data

    def write(self, data: bytes) -> None:
        """Send all of it.

        Raises:
            DeviceError: The line is broken, or takes nothing for half a second.
        """
        try:
            self._serial.write(data)
        except (OSError, ValueError) as error:
            raise DeviceError(f"{self._where}: {self.port}: {_plain(error)}") from error

    def set_baud(self, baud: int) -> None:
        """Change the speed of a serial port; does nothing on TCP."""
        if not self.is_tcp:
            self._serial.baudrate = baud

    def close(self) -> None:
        """Close the line; never raises, may be called twice. The reader's thread must have ended before."""
        line: Any = getattr(self._serial, "_socket", None)
        with contextlib.suppress(OSError):
            if line is None:
                self._serial.close()
                return
            # pyserial would sleep after closing a socket, and leave it open if the other end was gone before.
            self._serial.is_open = False
            line.shutdown(socket.SHUT_RDWR)
        line.close()


def _send_at_once(fd: int) -> None:
    """Switch off the gathering of small packets, which would delay commands."""
    with socket.socket(fileno=os.dup(fd)) as line, contextlib.suppress(OSError):
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def _plain(error: BaseException) -> str:
    """Say what happened and what helps, in one line."""
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, socket.gaierror):
            return "no such host (check the name, or give the address in numbers)"
        if isinstance(cause, TimeoutError):
            return "no answer (is the device switched on, and the address right?)"
        number = cause.args[0] if cause.args else None  # errno, also in termios.error
        if number in _REMEDIES:
            return _REMEDIES[number]
        cause = cause.__cause__ or cause.__context__
    return " ".join(str(error).split())


_REMEDIES = {
    errno.ECONNREFUSED: "nothing listens there (is the device, or 'zavis sim serve', running, and the port right?)",
    errno.EHOSTUNREACH: "the host cannot be reached (is it switched on and on this network?)",
    errno.ENETUNREACH: "the network cannot be reached (is this computer connected to it?)",
    errno.ECONNRESET: "the other end has broken the connection",
    errno.EPIPE: "the other end has closed the connection",
    errno.ENOENT: "there is no such port (plug the device in; 'ls /dev/serial/by-id' lists what is there)",
    errno.ENODEV: "the device has gone (is its cable plugged in?)",
    errno.EIO: "the device has gone (is its cable plugged in?)",
    errno.EACCES: "permission denied (join the group of the port: sudo usermod -aG dialout $USER, then log in again)",
    errno.EPERM: "permission denied (join the group of the port: sudo usermod -aG dialout $USER, then log in again)",
    errno.EBUSY: "another program uses the port (close it)",
    errno.ENOTTY: "is not a serial port",
}
