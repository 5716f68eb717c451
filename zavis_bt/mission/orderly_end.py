"""Signals that end a mission: held back until it can end in order."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_PATIENCE = 1.0  # so long a tick may go on after a signal [s]


class OrderlyEnd:
    """Ends a mission between two ticks when a signal asks for it, and passes the signal on when all is stopped.

    An exception out of a signal's handler can come up anywhere: compiled code that calls back swallows it or crashes.
    So the handler only asks the loop to stop. A tick that goes on for longer, or a second signal, is interrupted as
    usual. Signals that are ignored stay ignored. Outside of the main thread, where no signal arrives, nothing is done.
    """

    def __init__(self, stop: Callable[[str], None]) -> None:
        """Take what ends the loop, with a reason."""
        self._stop = stop
        self._arrived: int | None = None
        self._closing = False
        self._before: dict[int, Any] = {}
        self._timer: threading.Timer | None = None

    def __enter__(self) -> OrderlyEnd:
        if threading.current_thread() is threading.main_thread():
            for number in _SIGNALS:
                if signal.getsignal(number) not in (signal.SIG_IGN, None):  # None: not set by Python
                    self._before[number] = signal.signal(number, self._on_signal)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._restore()
        if self._arrived is not None:
            signal.raise_signal(self._arrived)

    def close(self) -> None:
        """Let nothing disturb what follows: the loop has ended, and everything is being stopped and written."""
        self._closing = True

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        first, self._arrived = self._arrived is None, number
        if self._closing:
            return
        if first:
            self._stop("interrupted")
            self._timer = threading.Timer(_PATIENCE, _send_again, [number])
            self._timer.daemon = True
            self._timer.start()
            return
        self._restore()
        self._arrived = None
        signal.raise_signal(number)

    def _restore(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before.clear()


def _send_again(number: int) -> None:
    main = threading.main_thread().ident
    if main is not None:
        signal.pthread_kill(main, number)
