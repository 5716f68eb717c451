"""What the benchmarks share: taking turns, medians of CPU time, and a line about the machine."""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable, Mapping, Sequence

Call = Callable[[], object]


def machine() -> str:
    """One line on where the figures come from; a high load says how far to trust them."""
    load = os.getloadavg()[0]
    return f"{os.cpu_count()} cores, Python {platform.python_version()}, load {load:.1f}"


def take_turns(calls: Mapping[str, Call], rounds: int, work: int = 1) -> dict[str, float]:
    """Return each call's median CPU seconds per unit of work.

    The calls alternate, so that whatever else the machine does falls on all alike; the first round compiles.
    """
    spent: dict[str, list[float]] = {name: [] for name in calls}
    for turn in range(rounds + 1):
        for name, call in calls.items():
            begin = time.process_time()
            call()
            if turn:
                spent[name].append((time.process_time() - begin) / work)
    return {name: statistics.median(values) for name, values in spent.items()}


def spread(values: Sequence[float]) -> str:
    """Return median and range, for printing."""
    return f"{statistics.median(values):.3g} ({min(values):.3g} to {max(values):.3g})"


def verdict(met: bool) -> str:
    return "met" if met else "MISSED"
