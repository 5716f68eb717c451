"""Values of the framework as JSON."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from zavis_bt.types import Candidate, RgbdFrame


def to_plain(value: Any) -> Any:
    """Return the value as what JSON knows: dicts, lists, text, numbers, booleans and None.

    Dataclasses and named tuples become objects of their fields, arrays lists; numbers that JSON has no word for (NaN,
    infinity) become None. A frame is reduced to its stamp: pictures do not belong into a text file. Anything else
    is written as its text.
    """
    match value:
        case None | bool() | str():
            return str(value) if isinstance(value, Enum) else value
        case int():
            return int(value)
        case float():
            return float(value) if math.isfinite(value) else None
        case np.generic() | np.ndarray():
            return to_plain(value.tolist())
        case RgbdFrame():
            return {"stamp": value.stamp}
        case Candidate():
            return candidate_to_plain(value)
        case Mapping():
            return {str(key): to_plain(item) for key, item in value.items()}
        case Path():
            return str(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: to_plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {name: to_plain(item) for name, item in zip(value._fields, value, strict=True)}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [to_plain(item) for item in (sorted(value, key=str) if isinstance(value, (set, frozenset)) else value)]
    return str(value)


def candidate_to_plain(candidate: Candidate) -> dict[str, Any]:
    """Return a candidate without its picture: target, score, box [px], position [m] and time of its frame [s]."""
    return {
        "target": candidate.target,
        "score": to_plain(candidate.score),
        "box": [to_plain(edge) for edge in candidate.box],
        "position": [to_plain(coordinate) for coordinate in candidate.position],
        "stamp": to_plain(candidate.frame.stamp),
    }


def to_json(value: Any, *, indent: int | None = 2) -> str:
    """Return valid JSON text of any value, ending in a newline."""
    return json.dumps(to_plain(value), indent=indent, ensure_ascii=False, allow_nan=False) + "\n"
