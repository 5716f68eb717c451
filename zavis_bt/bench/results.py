"""Results of a benchmark: one JSON object a line."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from zavis_bt.errors import InputError
from zavis_bt.types import MissionResult

RESULTS_FILE = "results.jsonl"
_DECIMALS = 6  # of every number in a file, so that the same run gives the same bytes
CRASH = "crash: "


@dataclass(frozen=True, slots=True)
class EpisodeResult(MissionResult):
    """How a mission ended, and the group of its episode."""

    group: str = ""

    @property
    def key(self) -> tuple[str, str, int]:
        """What tells results apart: episode, method and seed."""
        return self.id, self.method, self.seed

    @property
    def crashed(self) -> bool:
        """Whether the program failed, not the method."""
        return self.reason.startswith(CRASH)


def to_line(result: EpisodeResult) -> str:
    """Return the result as one line of JSON, without line end; numbers are rounded to six decimals.

    Raises:
        ValueError: A number is not finite, or ``details`` holds something that JSON has no word for.
    """
    return json.dumps(_plain(asdict(result)), ensure_ascii=False, allow_nan=False)


def _plain(value: Any) -> Any:
    """Return the value as JSON's types, floats rounded."""
    match value:
        case np.generic():
            return _plain(value.item())
        case float():
            return round(value, _DECIMALS) + 0.0  # no negative zero
        case Mapping():
            return {str(key): _plain(entry) for key, entry in value.items()}
        case list() | tuple():
            return [_plain(entry) for entry in value]
        case None | bool() | int() | str():
            return value
    raise ValueError(f"a result cannot hold {value!r:.60} (numbers, texts, lists and mappings only)")


_ADAPTER = TypeAdapter(EpisodeResult)


def from_line(text: str) -> EpisodeResult:
    """Return the result of one line.

    Raises:
        ValueError: The line is not a result.
    """
    return _ADAPTER.validate_json(text, extra="forbid")


def load_results(path: Path | str) -> list[EpisodeResult]:
    """Read results.

    Args:
        path: A results file, or the folder of a benchmark. An unfinished last line, which a killed run leaves, is
            passed over.

    Returns:
        The results in the order of the file.

    Raises:
        InputError: The file cannot be read, or a line is not a result.
    """
    path = Path(path)
    path = path / RESULTS_FILE if path.is_dir() else path
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror} (name a benchmark's folder)") from error
    results = []
    for number, line in enumerate(text.split("\n")[:-1], start=1):
        try:
            results.append(from_line(line))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            what = f"{'.'.join(str(key) for key in first['loc'])} {first['msg']}".strip()
            raise InputError(f"{path}:{number}: is not a result: {what} (remove the line to run it again)") from error
    return results
