"""What a training tells while it runs."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any

LOG = "log.jsonl"


class TrainingLog:
    """Losses as lines of JSON, and for TensorBoard where it is installed."""

    def __init__(self, folder: Path, *, every: int = 10) -> None:
        """Append to the folder's log; means over ``every`` iterations."""
        self._file = (folder / LOG).open("a", encoding="utf-8")
        self._board: Any = _board(folder)
        self._every, self._sums, self._count, self._since = every, dict[str, float](), 0, time.monotonic()

    def __enter__(self) -> TrainingLog:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        if self._board is not None:
            self._board.close()

    def write(self, iteration: int, losses: Mapping[str, float], rate: float) -> None:
        """Take an iteration's losses."""
        for name, loss in losses.items():
            self._sums[name] = self._sums.get(name, 0.0) + loss
        self._count += 1
        if iteration % self._every:
            return
        means = {name: value / self._count for name, value in self._sums.items()}
        seconds = (time.monotonic() - self._since) / self._count
        line = {"iteration": iteration, **{name: round(value, 5) for name, value in means.items()}}
        self._file.write(json.dumps(line | {"rate": rate, "seconds": round(seconds, 4)}) + "\n")
        self._file.flush()
        if self._board is not None:
            for name, value in means.items():
                self._board.add_scalar(f"loss/{name}", value, iteration)
        self._sums, self._count, self._since = {}, 0, time.monotonic()


def _board(folder: Path) -> Any:
    if find_spec("tensorboard") is None:
        return None
    from torch.utils.tensorboard import SummaryWriter

    return SummaryWriter(str(folder))
