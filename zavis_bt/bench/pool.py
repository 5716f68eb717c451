"""Work spread over processes that may crash, be interrupted or lose their parent.

A worker that dies takes down only the item it had; a parent that dies takes its workers with it.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
import traceback
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Generic, TypeVar

T = TypeVar("T")
R = TypeVar("R")

_ONE_THREAD = (
    "NUMBA_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "OPENCV_FOR_THREADS_NUM",
)
_PATIENCE = 2.0  # for a worker to end by itself [s]


@dataclass(frozen=True, slots=True)
class Crash:
    """Work that did not come to an end."""

    reason: str
    """One line."""
    traceback: str = ""
    """As Python prints it; empty where the process itself died."""


@dataclass(slots=True)
class _Worker(Generic[T, R]):
    process: SpawnProcess
    connection: Connection[tuple[int, T] | None, R | Crash]
    busy: int | None = None
    """Index of the item it has."""


def run_in_processes(work: Callable[[T], R], items: Sequence[T], workers: int) -> Generator[tuple[int, R | Crash]]:
    """Yield (index, outcome) of each item as it is completed.

    Close the iterator to end the workers early; they end with it, also when it is left by an exception.

    Args:
        work: Importable by name, or a `functools.partial` of such a function. What it raises becomes a `Crash`.
        items: What to work on, begun in this order; they are sent by pickle.
        workers: Number of processes; numeric libraries use one thread in each.
    """
    pool: list[_Worker[T, R]] = []
    upcoming = iter(range(len(items)))
    try:
        for _ in range(min(workers, len(items))):
            pool.append(_hired(work))
            _hand_next(pool[-1], upcoming, items)
        while any(worker.busy is not None for worker in pool):
            ready = wait([worker.connection for worker in pool if worker.busy is not None])
            for k, worker in enumerate(pool):
                if worker.connection not in ready or worker.busy is None:
                    continue
                index, outcome = worker.busy, _received(worker)
                if not worker.process.is_alive():
                    pool[k] = worker = _hired(work)
                _hand_next(worker, upcoming, items)
                yield index, outcome
    finally:
        _dismiss(pool)


def _hired(work: Callable[[T], R]) -> _Worker[T, R]:
    """Start a worker; Ctrl-C and the number of threads are settled before Python begins in it."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(theirs, work), daemon=True)
    resource_tracker.ensure_running()  # its start, which the first process brings about, would let the signal through
    with _environment(dict.fromkeys(_ONE_THREAD, "1")), _blocked(signal.SIGINT):
        process.start()
    theirs.close()
    return _Worker(process, ours)


def _hand_next(worker: _Worker[T, R], upcoming: Iterator[int], items: Sequence[T]) -> None:
    worker.busy = next(upcoming, None)
    with contextlib.suppress(BrokenPipeError):  # it died: that is seen when its outcome is read
        worker.connection.send(None if worker.busy is None else (worker.busy, items[worker.busy]))


def _received(worker: _Worker[T, R]) -> R | Crash:
    """Return what a worker sends, or how it died."""
    try:
        return worker.connection.recv()
    except (EOFError, ConnectionResetError):
        _end(worker.process)
        code = worker.process.exitcode
        if code is not None and code < 0:
            return Crash(f"the process was killed by {signal.Signals(-code).name}")
        return Crash(f"the process ended with exit code {code}")


def _dismiss(pool: Sequence[_Worker[T, R]]) -> None:
    """End the workers, whatever they are at."""
    for worker in pool:
        if worker.busy is not None:
            worker.process.terminate()
        worker.connection.close()
    for worker in pool:
        _end(worker.process)


def _end(process: SpawnProcess) -> None:
    """Wait for a process that is about to end, but not for long."""
    process.join(_PATIENCE)
    if process.is_alive():
        process.kill()
        process.join()


def _serve(connection: Connection[object, tuple[int, T] | None], work: Callable[[T], R]) -> None:
    """Work until told to stop; the life of a worker."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while (job := connection.recv()) is not None:
        try:
            outcome: R | Crash = work(job[1])
        except Exception as error:  # one item's bug is its outcome: it must not end the worker and the items that wait
            outcome = Crash(f"{type(error).__name__}: {error}".splitlines()[0], traceback.format_exc())
        connection.send(outcome)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextlib.contextmanager
def _environment(changes: dict[str, str]) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _blocked(number: signal.Signals) -> Iterator[None]:
    """Hold a signal back; children inherit that, so that Ctrl-C reaches the parent alone."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {number})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
