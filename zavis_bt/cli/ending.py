"""Ending in order when a signal says so."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

_ASKED = (signal.SIGTERM, signal.SIGHUP)


class Ended(KeyboardInterrupt):
    """A signal asked the program to end."""


@contextmanager
def signals_end() -> Iterator[None]:
    """Raise `Ended` where the program is when SIGTERM or SIGHUP arrives, as Ctrl-C raises KeyboardInterrupt.

    So whatever moves is stopped by the same `finally` on every way out. Only for the main thread.
    """
    with _handled(_end, *_ASKED):
        yield


@contextmanager
def undisturbed() -> Iterator[None]:
    """Ignore Ctrl-C, SIGTERM and SIGHUP for as long as it takes to stop what moves. Only for the main thread."""
    with _handled(signal.SIG_IGN, signal.SIGINT, *_ASKED):
        yield


@contextmanager
def _handled(handler: Any, *numbers: signal.Signals) -> Iterator[None]:
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


def _end(number: int, frame: Any) -> NoReturn:
    raise Ended(signal.Signals(number).name)
