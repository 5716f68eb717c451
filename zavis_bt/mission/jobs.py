"""Executors for slow work: inline for lock-step runs, threads for real time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from zavis_bt.protocols import Clock

T = TypeVar("T")

LATENCY = MappingProxyType({"detect": 0.1, "plan": 0.05, "waypoints": 0.1})
"""What each kind of work costs on the robot's computer [s]; charged to the mission's clock in lock step."""


class InlineJob(Generic[T]):
    """Work that was done when it was submitted, and counts as done once its latency has passed."""

    def __init__(self, clock: Clock, ready_at: float, outcome: Callable[[], T]) -> None:
        self._clock, self._ready_at, self._outcome = clock, ready_at, outcome

    def done(self) -> bool:
        """Return whether the charged latency has passed."""
        return self._clock.now() >= self._ready_at - 1e-9

    def result(self) -> T:
        """Return the outcome or raise what the work raised; the latency is not waited for."""
        return self._outcome()

    def cancel(self) -> None:
        """Nothing to drop: the work is already done."""


class InlineJobs:
    """Executor of a lock-step run: no threads, so that a run is a pure function of its files and its seed."""

    def __init__(self, clock: Clock, latency: Mapping[str, float] = LATENCY) -> None:
        """Describe the executor.

        Args:
            clock: The mission's clock.
            latency: Simulated duration for each label [s]; 0 for labels that are not listed.
        """
        self._clock, self._latency = clock, latency

    def submit(self, label: str, work: Callable[..., T], *args: Any) -> InlineJob[T]:
        """Do the work now; the job is done ``latency[label]`` seconds later."""
        ready_at = self._clock.now() + self._latency.get(label, 0.0)
        try:
            value = work(*args)
        except Exception as error:  # as an executor's future does: raised again for whoever asks for the result
            failure = error

            def fail() -> T:
                raise failure

            return InlineJob(self._clock, ready_at, fail)
        return InlineJob(self._clock, ready_at, lambda: value)

    def close(self) -> None:
        """Nothing runs on."""


class ThreadJob(Generic[T]):
    """Work on a thread."""

    def __init__(self, future: Future[T]) -> None:
        self._future = future

    def done(self) -> bool:
        """Return whether the work has ended."""
        return self._future.done()

    def result(self) -> T:
        """Wait for the outcome, or raise what the work raised."""
        return self._future.result()

    def cancel(self) -> None:
        """Drop the work if it has not begun."""
        self._future.cancel()


class ThreadJobs:
    """Executor of a real-time run: one worker thread a label, so that planning never waits for detection."""

    def __init__(self) -> None:
        self._pools: dict[str, ThreadPoolExecutor] = {}

    def submit(self, label: str, work: Callable[..., T], *args: Any) -> ThreadJob[T]:
        """Queue the work on its label's thread."""
        if label not in self._pools:
            self._pools[label] = ThreadPoolExecutor(max_workers=1, thread_name_prefix=f"job-{label}")
        return ThreadJob(self._pools[label].submit(work, *args))

    def close(self) -> None:
        """Drop what has not begun; work under way ends by itself."""
        for pool in self._pools.values():
            pool.shutdown(wait=False, cancel_futures=True)


class DoneJob(Generic[T]):
    """A value in the shape of a job, for work that needs no time."""

    def __init__(self, value: T) -> None:
        self._value = value

    def done(self) -> bool:
        """Return True."""
        return True

    def result(self) -> T:
        """Return the value."""
        return self._value

    def cancel(self) -> None:
        """Nothing to drop."""
