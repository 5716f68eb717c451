"""What is to be said of a mean of models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def averaged_facts(facts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return what is worth knowing of a mean: the last model's facts, and as held out only what none was shown."""
    held_out = [frozenset(one.get("held_out", ())) for one in facts]
    return {**facts[-1], "held_out": sorted(frozenset.intersection(*held_out)), "average_of": len(facts)}
