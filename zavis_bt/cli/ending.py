"""Ending in order when a signal says so."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator
from typing import Any, NoReturn

_ASKED = (signal.SIGTERM, signal.SIGHUP)


class Ended(KeyboardInterrupt):
    """A signal asked the program to end; its argument is the signal's name."""

    @property
    def exit_code(self) -> int:
        """What a shell says of a program that the signal ended."""
        return 128 + signal.Signals[str(self)].value


@contextlib.contextmanager
def signals_end() -> Iterator[None]:
    """Raise `Ended` where the program is when SIGTERM or SIGHUP arrives, as Ctrl-C raises KeyboardInterrupt.

    So whatever moves is stopped by the same `finally` on every way out, which further signals do not disturb. A signal
    that is ignored already (nohup) stays ignored. Does nothing outside of the main thread, where no signal arrives.
    """
    asked = [number for number in _ASKED if signal.getsignal(number) is not signal.SIG_IGN]
    with _handled(_end, *asked):
        yield


def say_last(text: str) -> None:
    """Print a last line, as far as somebody is left to read it."""
    with contextlib.suppress(OSError):
        print(text, file=sys.stderr, flush=True)
    drop_what_nobody_reads()


def drop_what_nobody_reads() -> None:
    """Let output end in nothing if the terminal is gone: what is left in buffers must not spoil the exit code."""
    try:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for descriptor in (1, 2):
            os.dup2(nowhere, descriptor)


@contextlib.contextmanager
def undisturbed() -> Iterator[None]:
    """Ignore Ctrl-C, SIGTERM and SIGHUP for as long as it takes to stop what moves. Only for the main thread."""
    with _handled(signal.SIG_IGN, signal.SIGINT, *_ASKED):
        yield


@contextlib.contextmanager
def _handled(handler: Any, *numbers: signal.Signals) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


def _end(number: int, frame: Any) -> NoReturn:
    for asked in _ASKED:
        signal.signal(asked, signal.SIG_IGN)
    raise Ended(signal.Signals(number).name)
