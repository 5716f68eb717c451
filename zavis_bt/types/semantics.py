"""What is seen and what it means: landmarks, viewpoints, candidates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types.motion import FloatArray, Pose2D
from zavis_bt.types.sensing import Box, RgbdFrame


@dataclass(frozen=True, slots=True)
class LandmarkSighting:
    """A landmark seen in one frame, projected to the map with that frame's depth."""

    probabilities: tuple[tuple[str, float], ...]
    """Label distribution, summing to 1."""
    position: tuple[float, float, float]
    """Middle of the seen surface, map frame [m]."""
    radius: float
    """Half the seen horizontal extent [m]."""
    score: float
    stamp: float

    @property
    def label(self) -> str:
        """The most probable name."""
        return max(self.probabilities, key=lambda pair: pair[1])[0]


def entropy(probabilities: FloatArray) -> float:
    """Return the entropy of a distribution [nat], with 0 log 0 = 0."""
    p = np.asarray(probabilities, dtype=np.float64)
    p = p[p > 0]
    return float(-(p * np.log(p)).sum())


@dataclass(frozen=True, slots=True)
class Landmark:
    """A piece of furniture on the semantic map: one instance, its label fused over all its sightings."""

    id: int
    probabilities: tuple[tuple[str, float], ...]
    """Label distribution, summing to 1."""
    position: tuple[float, float, float]
    """Middle, map frame [m]."""
    radius: float
    """Half its horizontal extent, as far as it was seen [m]."""
    views: int
    """Number of sightings fused."""

    @property
    def label(self) -> str:
        """The most probable name."""
        return max(self.probabilities, key=lambda pair: pair[1])[0]

    @property
    def entropy(self) -> float:
        """Semantic uncertainty σ_c [nat] (Eq. semantic_uncertainty)."""
        return entropy(np.array([p for _, p in self.probabilities]))


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """Where to stand and where to look to see a landmark."""

    pose: Pose2D
    """Where the robot stands, facing the landmark; map frame."""
    look_at: tuple[float, float, float]
    """Point to aim the camera at, map frame [m]."""
    radius: float
    """Half the horizontal extent of what is looked at [m]."""
    landmark: int
    """Id of the landmark."""
    label: str


@dataclass(frozen=True, slots=True)
class Candidate:
    """A box that may be the target, with what a person needs to judge it."""

    target: str
    score: float
    """Matching score m on the 100 × cosine scale (Eq. matching_score)."""
    box: Box
    position: tuple[float, float, float]
    """Where it is, map frame [m]."""
    frame: RgbdFrame
    """The frame it was seen in."""

    @property
    def patch(self) -> NDArray[np.uint8]:
        """The image inside the box, (h, w, 3) uint8."""
        return self.frame.crop(self.box)


@dataclass(frozen=True, slots=True)
class Percept:
    """What one frame shows: landmarks, and candidates for the target, best first."""

    sightings: tuple[LandmarkSighting, ...] = ()
    candidates: tuple[Candidate, ...] = ()


@dataclass(frozen=True, slots=True)
class Answer:
    """A person's answer: the index of the candidate that is the target, or None if none is."""

    accepted: int | None
    reason: str = ""
