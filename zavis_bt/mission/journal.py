"""The mission's journal: what behaviours report, for counting, showing and recording."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

from zavis_bt.protocols import Clock
from zavis_bt.types import Candidate, Event, Path, Viewpoint


class MissionJournal:
    """Events in the order they happened, and the latest of what viewers show.

    Kinds that have a meaning here: ``viewpoints`` (viewpoints: the order ahead), ``visit`` (viewpoint: the robot
    stands at it), ``path`` (path: being followed, or None), ``candidates`` (candidates: newly seen), ``ask``
    (candidates: shown to the person), ``found`` (candidate: confirmed). Any other kind is kept and counted.
    """

    def __init__(self, clock: Clock) -> None:
        """Start empty; ``clock`` stamps the events."""
        self._clock = clock
        self.sinks: list[Callable[[Event], None]] = []
        self.counts: Counter[str] = Counter()
        self.path: Path | None = None
        self.viewpoints: tuple[Viewpoint, ...] = ()
        self.visited: list[Viewpoint] = []
        self.candidates: list[Candidate] = []
        self.found: Candidate | None = None

    def record(self, kind: str, **data: Any) -> None:
        """Note an event."""
        self.counts[kind] += 1
        match kind:
            case "viewpoints":
                self.viewpoints = tuple(data["viewpoints"])
            case "visit":
                self.visited.append(data["viewpoint"])
                self.viewpoints = tuple(v for v in self.viewpoints if v.landmark != data["viewpoint"].landmark)
            case "path":
                self.path = data["path"]
            case "candidates":
                self.candidates.extend(data["candidates"])
            case "found":
                self.found = data["candidate"]
        event = Event(self._clock.now(), kind, data)
        for sink in self.sinks:
            sink(event)
