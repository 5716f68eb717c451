"""What a mission is composed of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from zavis_bt.perception import Thresholds
from zavis_bt.protocols import Clock, Detector, Human, Jobs, KnowledgePrior, Matcher, Robot


@dataclass(frozen=True, slots=True)
class Task:
    """Which mission this is, for its result."""

    id: str
    method: str
    seed: int
    shortest_path_length: float | None = None


@dataclass(frozen=True, slots=True)
class Parts:
    """What a mission is composed of; the command line and the benchmark choose them."""

    robot: Robot
    clock: Clock
    jobs: Jobs
    detector: Detector
    matcher: Matcher
    prior: KnowledgePrior
    human: Human
    rng: np.random.Generator
    details: Callable[[], Mapping[str, Any]] = dict
    """Further counts for the result that only whoever plays the robot knows."""
    thresholds: Thresholds = field(default_factory=Thresholds)
    """What the scores of detector and matcher mean."""
