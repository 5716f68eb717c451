"""The loop that ticks a tree: rate, pause, reload, containment, and an orderly end whatever happens."""

from __future__ import annotations

import logging
import math
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from py_trees.common import Status

from zavis_bt.errors import ZavisError
from zavis_bt.protocols import Clock
from zavis_bt.tree.tree import Tree

log = logging.getLogger(__name__)

Hook = Callable[[], None]

TOLERANCE = 1e-9
"""What a sum of periods may lack in the last digits [s]."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a run ended."""

    status: Status
    """SUCCESS or FAILURE of the root, INVALID if it was stopped from outside."""
    reason: str
    node: str
    """Id of the node that decided; empty if it was stopped from outside."""


class Runner:
    """Ticks a tree at a rate until it ends.

    A turn is: ``before`` hooks (read devices, update the map), the tree's tick, ``after`` hooks (safety, observers),
    and waiting for the next turn. While paused or held, everything but the tick goes on.
    """

    def __init__(
        self,
        tree: Tree,
        clock: Clock,
        *,
        rate: float = 10.0,
        before: Sequence[Hook] = (),
        after: Sequence[Hook] = (),
        on_exit: Sequence[Hook] = (),
        hold: Callable[[], bool] = lambda: False,
        on_pause: Hook | None = None,
        on_resume: Hook | None = None,
    ) -> None:
        """Prepare a run.

        Args:
            tree: Already set up.
            clock: The mission's time.
            rate: Turns a second [Hz].
            before: Called before each tick.
            after: Called after each tick.
            on_exit: Called once at the end, however it comes, each whatever the others do.
            hold: Asked before each tick; while it says True the tree is held as in a pause.
            on_pause: Called once when a pause or hold begins, between ticks.
            on_resume: Called once before the first tick after it.
        """
        self.tree = tree
        self.ticks = 0
        self.overruns = 0
        """Turns that were left out since one before took too long."""
        self._clock = clock
        self._period = 1.0 / rate
        self._before, self._after = tuple(before), tuple(after)
        self._on_exit, self._hold = tuple(on_exit), hold
        self._on_pause, self._on_resume = on_pause, on_resume
        self._paused = threading.Event()
        self._lock = threading.Lock()
        self._stop_reason: str | None = None
        self._factory: Callable[[], Tree] | None = None

    @property
    def paused(self) -> bool:
        """Whether somebody has paused the tree."""
        return self._paused.is_set()

    def pause(self) -> None:
        """Hold the tree from the next turn on; may be called from any thread."""
        self._paused.set()

    def resume(self) -> None:
        """Tick again; may be called from any thread."""
        self._paused.clear()

    def stop(self, reason: str) -> None:
        """End the run before the next tick; the first reason counts. May be called from any thread."""
        with self._lock:
            if self._stop_reason is None:
                self._stop_reason = reason

    def request_reload(self, tree_factory: Callable[[], Tree]) -> None:
        """Replace the tree between two ticks; may be called from any thread.

        The old tree is stopped before the new one begins, from its root. If the new one says the same as the old one
        (only comments or layout differ), or the factory fails (the file has a fault, which is logged), the old tree
        goes on undisturbed.

        Args:
            tree_factory: Returns the new tree, set up.
        """
        with self._lock:
            self._factory = tree_factory

    def run(self) -> Outcome:
        """Tick until the root has ended or `stop` was called.

        Raises:
            BaseException: What a hook raised, or KeyboardInterrupt, after everything was stopped.
        """
        try:
            return self._loop()
        finally:
            self._finish()

    def _loop(self) -> Outcome:
        start, turn, held = self._clock.now(), 0, False
        while True:
            for hook in self._before:
                hook()
            self._reload()
            if self._stop_reason is None:
                held = self._turn(held)
                for hook in self._after:
                    hook()
            if (outcome := self._outcome()) is not None:
                return outcome
            turn = self._next_turn(start, turn)
            self._clock.wait_until(start + turn * self._period)

    def _outcome(self) -> Outcome | None:
        """Return how the run has ended, or None if it goes on; the tree's own end counts before a stop."""
        if self.tree.status in (Status.SUCCESS, Status.FAILURE):
            decider = self.tree.decider()
            return Outcome(self.tree.status, decider.reason, decider.id)
        return None if self._stop_reason is None else Outcome(Status.INVALID, self._stop_reason, "")

    def _turn(self, held: bool) -> bool:
        """Tick, or hold; return whether the tree is held."""
        hold = self._paused.is_set() or self._hold()
        change = self._on_pause if hold else self._on_resume
        if hold is not held and change is not None:
            change()
        if not hold:
            self.tree.tick()
            self.ticks += 1
        return hold

    def _next_turn(self, start: float, turn: int) -> int:
        late = (self._clock.now() - start) / self._period - (turn + 1)
        missed = max(math.ceil(late - TOLERANCE), 0)
        self.overruns += missed
        return turn + 1 + missed

    def _reload(self) -> None:
        with self._lock:
            factory, self._factory = self._factory, None
        if factory is None:
            return
        try:
            tree = factory()
        except ZavisError as error:
            log.error("the tree was not reloaded:\n%s", error)
            return
        if tree.source is None or tree.source != self.tree.source:
            self.tree.stop()
            self.tree = tree

    def _finish(self) -> None:
        for action in (self.tree.stop, *self._on_exit):
            try:
                action()
            except Exception:  # containment: nothing may keep the remaining hooks from being called
                log.exception("%s raised at the end of the run", action)
