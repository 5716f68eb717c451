"""What all sightings of one thing say together."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from zavis_bt.types import Landmark, LandmarkSighting

FLOOR = 1e-3
"""Least probability of a label in one sighting, so that no view can rule a label out for good."""

_LEAST_WEIGHT = 1e-3  # of a sighting, so that a score of 0 counts too
_LEAST_FUSED = 1e-300  # probability after many views, to have a logarithm
_MAX_RADIUS = 1.5  # of a landmark, however far its sightings are spread [m]


@dataclass(frozen=True)
class Evidence:
    """Sums over sightings, weighted by their scores. Adding is commutative: the order of sightings does not matter."""

    weight: float
    """Sum of the weights w."""
    views: int
    log_sums: Mapping[str, float]
    """For each label the sum of w log p; a label a sighting does not name has probability `FLOOR` in it."""
    position_sums: tuple[float, float, float]
    """Sum of w (x, y, z), map frame."""
    square_sum: float
    """Sum of w (x² + y²)."""
    largest: float
    """Largest radius of a sighting [m]."""

    @classmethod
    def of(cls, sighting: LandmarkSighting) -> Evidence:
        """Return the evidence of a single sighting."""
        weight = max(sighting.score, _LEAST_WEIGHT)
        x, y, z = sighting.position
        return cls(
            weight,
            1,
            {label: weight * math.log(max(p, FLOOR)) for label, p in sighting.probabilities},
            (weight * x, weight * y, weight * z),
            weight * (x * x + y * y),
            sighting.radius,
        )

    @classmethod
    def remembered(cls, landmark: Landmark) -> Evidence:
        """Return evidence that amounts to a landmark, with all its views of full weight."""
        weight, (x, y, z) = float(landmark.views), landmark.position
        power = math.sqrt(landmark.views) / weight
        return cls(
            weight,
            landmark.views,
            {label: math.log(max(p, _LEAST_FUSED)) / power for label, p in landmark.probabilities},
            (weight * x, weight * y, weight * z),
            weight * (x * x + y * y),
            landmark.radius,
        )

    def __add__(self, other: Evidence) -> Evidence:
        labels = dict.fromkeys([*self.log_sums, *other.log_sums])
        x, y, z = (a + b for a, b in zip(self.position_sums, other.position_sums, strict=True))
        return Evidence(
            self.weight + other.weight,
            self.views + other.views,
            {label: self._log_sum(label) + other._log_sum(label) for label in labels},
            (x, y, z),
            self.square_sum + other.square_sum,
            max(self.largest, other.largest),
        )

    def _log_sum(self, label: str) -> float:
        return self.log_sums.get(label, self.weight * math.log(FLOOR))

    @cached_property
    def probabilities(self) -> dict[str, float]:
        """The fused label distribution: the product of all views to the power of n^½ / n.

        The plain product would take the n views for independent, which looks at one thing from nearby never are;
        the mean would never become surer. Views that agree sharpen the distribution, views that disagree flatten it.
        """
        power = math.sqrt(self.views) / self.weight
        top = max(self.log_sums.values())
        shares = {label: math.exp(power * (value - top)) for label, value in self.log_sums.items()}
        total = sum(shares.values())
        return {label: share / total for label, share in sorted(shares.items(), key=lambda item: (-item[1], item[0]))}

    @property
    def label(self) -> str:
        """The most probable name."""
        return next(iter(self.probabilities))

    @cached_property
    def position(self) -> tuple[float, float, float]:
        """Weighted mean of the sightings [m]."""
        x, y, z = (value / self.weight for value in self.position_sums)
        return x, y, z

    @cached_property
    def radius(self) -> float:
        """Half the horizontal extent [m]: grows with the spread of the sightings, at most to twice the largest."""
        x, y, _ = self.position
        spread = math.sqrt(max(self.square_sum / self.weight - x * x - y * y, 0.0))
        grown = max(self.largest, 0.5 * self.largest + spread)
        return min(grown, 2 * self.largest, _MAX_RADIUS)

    def similarity(self, other: Evidence) -> float:
        """Return the cosine of the two label distributions, 0 to 1."""
        a, b = self.probabilities, other.probabilities
        product = sum(p * b.get(label, 0.0) for label, p in a.items())
        return product / (math.hypot(*a.values()) * math.hypot(*b.values()))
