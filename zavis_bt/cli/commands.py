"""Lines that somebody types, or that come through a pipe, while the program does other things."""

from __future__ import annotations

import contextlib
import os
import select
import sys
import time
from collections.abc import Sequence
from types import TracebackType
from typing import Protocol

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from zavis_bt.cli.keyboard import Keyboard
from zavis_bt.cli.line_editor import LineEditor

_CHUNK = 4096


class CommandLine(Protocol):
    """Where commands come from and their answers go to: a context."""

    def lines(self, timeout: float) -> Sequence[str]:
        """Return the lines that were completed within ``timeout`` [s], soon after the first one."""

    def say(self, text: str) -> None:
        """Show an answer."""

    def show(self, status: str) -> None:
        """Show how things stand now; it replaces what was shown before."""

    def __enter__(self) -> CommandLine: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def command_line(console: Console) -> CommandLine:
    """Return a prompt with a status line for somebody at the terminal, else plain lines from standard input."""
    return Prompt(console) if console.is_terminal and _in_foreground() else PlainLines(console)


def _in_foreground() -> bool:
    """Return whether standard input is a terminal that listens to this program, not to another one."""
    try:
        fd = sys.stdin.fileno()
        if not os.isatty(fd):
            return False
    except (OSError, ValueError, AttributeError):  # closed, or replaced by something that is no file
        return False
    try:
        return os.tcgetpgrp(fd) == os.getpgrp()
    except OSError:  # a terminal that no shell shares out
        return True


class Prompt:
    """A status line, and below it the line being typed; answers scroll by above."""

    def __init__(self, console: Console) -> None:
        self._console, self._keyboard, self._editor = console, Keyboard(), LineEditor()
        self._live = Live(console=console, auto_refresh=False, transient=True)
        self._status = ""

    def __enter__(self) -> Prompt:
        self._keyboard.__enter__()
        self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with contextlib.suppress(OSError):  # the terminal may be gone
            self._live.stop()
        self._keyboard.__exit__(kind, error, trace)

    def lines(self, timeout: float) -> list[str]:
        """Return the lines completed; ends with KeyboardInterrupt where the terminal has been closed."""
        try:
            keys = self._keyboard.pressed(timeout)
        except EOFError:
            raise KeyboardInterrupt from None
        found = [line for key in keys if (line := self._editor.press(key)) is not None]
        if keys:
            self._draw()
        return found

    def say(self, text: str) -> None:
        """Show an answer above the status."""
        self._live.console.print(text, soft_wrap=True)

    def show(self, status: str) -> None:
        """Change the status line."""
        self._status = status
        self._draw()

    def _draw(self) -> None:
        status = Text(self._status, style="dim", no_wrap=True, overflow="ellipsis")
        typed = Text(f"> {self._editor.text}▏", no_wrap=True, overflow="ellipsis")
        self._live.update(Group(status, typed), refresh=True)


class PlainLines:
    """Lines from standard input, whatever it is; when it ends, there are simply no more."""

    def __init__(self, console: Console) -> None:
        self._console, self._rest = console, b""
        self._fd = self._readable()

    def __enter__(self) -> PlainLines:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None

    def lines(self, timeout: float) -> list[str]:
        """Return the lines that have arrived."""
        if self._fd is None:
            time.sleep(timeout)
            return []
        if not select.select([self._fd], [], [], timeout)[0]:
            return []
        try:
            data = os.read(self._fd, _CHUNK)
        except OSError:  # a terminal that was closed
            data = b""
        if not data:
            self._fd, data = None, b"\n"  # what came last may lack its line's end
        *lines, self._rest = (self._rest + data).split(b"\n")
        return [line.decode("utf-8", "replace") for line in lines if line.strip()]

    def say(self, text: str) -> None:
        """Print an answer."""
        self._console.print(text, soft_wrap=True)

    def show(self, status: str) -> None:
        """Keep it: a file or a pipe wants no line a second."""

    @staticmethod
    def _readable() -> int | None:
        """Return what to read, or None: nothing is there, or a terminal listens to another program."""
        try:
            fd = sys.stdin.fileno()
        except (OSError, ValueError, AttributeError):  # closed, or not a file
            return None
        return None if os.isatty(fd) and not _in_foreground() else fd
