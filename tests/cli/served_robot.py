"""A simulated robot's devices for tests of commands, and a person at a terminal."""

from __future__ import annotations

import fcntl
import os
import pty
import select
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from sim.devices.serve import SimulatedDevices
from sim.world_file import load_world
from sim.worlds import builtin_world
from zavis_bt.cli.files import load_robot_spec

PATIENCE = 40.0


@contextmanager
def served() -> Iterator[SimulatedDevices]:
    world = load_world(builtin_world("flat"))
    with SimulatedDevices(world, load_robot_spec("pioneer3at_sim"), world.starts[0]) as devices:
        yield devices


class Person:
    """Somebody at a terminal in which ``zavis`` runs."""

    def __init__(self, *args: object) -> None:
        self.terminal, inside = pty.openpty()
        self._before = termios.tcgetattr(self.terminal)
        self.seen = ""
        self.process = subprocess.Popen(
            [sys.executable, "-m", "zavis_bt", *map(str, args)],
            stdin=inside,
            stdout=inside,
            stderr=inside,
            start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
        )
        os.close(inside)

    def type(self, keys: str) -> None:
        os.write(self.terminal, keys.encode())

    def look(self, seconds: float = 0.05) -> None:
        """Read what the terminal shows."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if select.select([self.terminal], [], [], left)[0]:
                try:
                    self.seen += os.read(self.terminal, 65536).decode("utf-8", "replace")
                except OSError:  # the program has gone
                    time.sleep(left)
                    return

    def until(self, condition: Callable[[], bool], keys: str = "") -> bool:
        """Look, and press keys again and again, until it is so."""
        end = time.monotonic() + PATIENCE
        while not condition() and time.monotonic() < end and self.process.poll() is None:
            if keys:
                self.type(keys)
            self.look()
        return condition()

    def sees(self, text: str, keys: str = "") -> bool:
        return self.until(lambda: text in self.seen, keys)

    def hang_up(self) -> None:
        os.close(self.terminal)
        self.terminal = -1

    def leaves_the_terminal_as_it_was(self) -> bool:
        return termios.tcgetattr(self.terminal) == self._before

    def exit_code(self) -> int:
        end = time.monotonic() + PATIENCE
        while self.process.poll() is None and time.monotonic() < end:
            if self.terminal >= 0:
                self.look()
            else:
                time.sleep(0.05)
        return self.process.wait(0.1)

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        if self.terminal >= 0:
            os.close(self.terminal)


@contextmanager
def person(*args: object) -> Iterator[Person]:
    somebody = Person(*args)
    try:
        yield somebody
    finally:
        somebody.close()
