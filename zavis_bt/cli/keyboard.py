"""Single keys from a terminal, without Enter and without echo."""

from __future__ import annotations

import contextlib
import os
import re
import select
import sys
import termios
import tty
from types import TracebackType

from zavis_bt.errors import InputError

_SEQUENCE = re.compile(rb"\x1b(?:\[[0-9;?]*[ -/]*[@-~]|O[A-Za-z])")
_ARROWS = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}
_ESCAPE = 0x1B
_CHUNK = 1024

KEY_ESCAPE, KEY_OTHER = "escape", "other"


def split_keys(data: bytes) -> tuple[list[str], bytes]:
    """Return the keys that bytes from a terminal mean.

    Args:
        data: Bytes as they arrived.

    Returns:
        Characters, ``up``, ``down``, ``left``, ``right``, or `KEY_OTHER` for keys without a name of their own; and
        the rest that may be the beginning of a key's sequence.
    """
    keys: list[str] = []
    while data:
        if data[0] != _ESCAPE:
            text = data.partition(b"\x1b")[0]
            keys += text.decode("utf-8", "replace")
            data = data[len(text) :]
        elif found := _SEQUENCE.match(data):
            keys.append(_ARROWS.get(found.group()[-1:], KEY_OTHER))
            data = data[found.end() :]
        elif len(data) == 1 or data[1:2] in b"[O":
            break
        else:  # a key pressed together with Alt
            keys.append(KEY_OTHER)
            data = data[2:]
    return keys, data


class Keyboard:
    """The terminal's keys, one by one, as a context: left however it may be, the terminal is as it was.

    Ctrl-C still interrupts; Ctrl-Z and Ctrl-S are keys like others, as nobody may fall asleep at the wheel.
    """

    def __init__(self, fd: int | None = None) -> None:
        """Use the terminal of standard input, or of an open file.

        Raises:
            InputError: It is not a terminal.
        """
        self._fd = _standard_input() if fd is None else fd
        self._rest = b""
        if not os.isatty(self._fd):
            raise InputError("the keyboard: standard input is not a terminal (run it in one, not through a pipe)")

    def __enter__(self) -> Keyboard:
        self._before = termios.tcgetattr(self._fd)
        tty.setcbreak(self._fd)
        mode = termios.tcgetattr(self._fd)
        mode[0] &= ~termios.IXON
        disabled = os.fpathconf(self._fd, "PC_VDISABLE")
        mode[6][termios.VSUSP] = bytes([disabled])
        termios.tcsetattr(self._fd, termios.TCSANOW, mode)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with contextlib.suppress(termios.error, OSError):  # the terminal may be gone
            termios.tcsetattr(self._fd, termios.TCSAFLUSH, self._before)

    def pressed(self, timeout: float = 0.0) -> list[str]:
        """Return the keys since the last call, waiting up to ``timeout`` [s] for one.

        Raises:
            EOFError: The terminal has been closed.
        """
        if not select.select([self._fd], [], [], timeout)[0]:
            rest, self._rest = self._rest, b""  # nothing follows: it was the Escape key itself, or a key cut short
            return [KEY_ESCAPE if rest == b"\x1b" else KEY_OTHER] if rest else []
        try:
            data = os.read(self._fd, _CHUNK)
        except OSError as error:  # how Linux reports a terminal whose other end was closed
            raise EOFError("the terminal has been closed") from error
        if not data:
            raise EOFError("the terminal has been closed")
        keys, self._rest = split_keys(self._rest + data)
        return keys


def _standard_input() -> int:
    try:
        return sys.stdin.fileno()
    except (OSError, ValueError, AttributeError):  # closed, or replaced by something that is no file
        return -1
