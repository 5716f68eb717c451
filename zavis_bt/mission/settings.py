"""What a mission is asked to do, and its bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from zavis_bt.errors import InputError
from zavis_bt.mission.safety import SafetySettings

MAX_TARGET_LENGTH = 200


@dataclass(frozen=True, slots=True)
class Search:
    """What is looked for, and the furniture that guides the search."""

    target: str
    """Free-form name, e.g. "the red wallet"."""
    known: tuple[str, ...]
    """Landmark names among the detector's classes."""
    unknown: tuple[str, ...]
    """Landmark names that text-image matching tells apart."""

    def __post_init__(self) -> None:
        """Check the texts.

        Raises:
            InputError: The target is empty, too long or not printable, or there is an empty or doubled landmark name.
        """
        if not self.target.strip():
            raise InputError('target: the text is empty (say what to look for, e.g. "red wallet")')
        if len(self.target) > MAX_TARGET_LENGTH:
            raise InputError(
                f"target: {len(self.target)} characters (a name or short description of at most {MAX_TARGET_LENGTH})"
            )
        if not self.target.isprintable():
            raise InputError("target: has line breaks or control characters (one line of plain text)")
        _check_names([*self.known, *self.unknown])


def _check_names(names: Sequence[str]) -> None:
    for name in names:
        if not name.strip():
            raise InputError("landmarks: a name is empty (remove it)")
        if names.count(name) > 1:
            raise InputError(f"landmarks: '{name}' is given twice (once, as known or as unknown)")


@dataclass(frozen=True, slots=True)
class MissionSettings:
    """Bounds and rates."""

    rate: float = 10.0
    """Ticks a second [Hz]."""
    max_travel: float = 50.0
    """Driven distance after which the search has failed [m] (paper, section on simulation)."""
    max_seconds: float = 1800.0
    """Duration after which the search has failed [s]."""
    resolution: float = 0.05
    """Side of a map cell [m]."""
    planner: str = "astar"
    """Global planner by name."""
    smooth: bool = False
    """Whether the base's commands on a path are limited in jerk."""
    safety: SafetySettings = field(default_factory=SafetySettings)
