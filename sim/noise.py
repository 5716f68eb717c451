"""Imperfections of the simulated devices, and independent streams of random numbers by name."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.types import FloatArray


@dataclass(frozen=True, slots=True)
class NoiseSettings:
    """How far the devices are from perfect; all zero is perfect.

    The odometry's error is a random walk in the manner of the four-parameter motion model (Thrun, Burgard, Fox:
    Probabilistic Robotics, ch. 5), with variances that grow with the way, so that they do not depend on how often the
    odometry is read.
    """

    range_sigma: float = 0.0
    """Standard deviation of a LiDAR range [m]."""
    range_dropout: float = 0.0
    """Share of beams that return nothing, 0 to 1."""
    rotation_per_radian: float = 0.0
    """[rad²/rad]"""
    rotation_per_metre: float = 0.0
    """[rad²/m]"""
    distance_per_metre: float = 0.0
    """[m²/m]"""
    distance_per_radian: float = 0.0
    """[m²/rad]"""

    def __post_init__(self) -> None:
        for name in self.__slots__:
            if not getattr(self, name) >= 0:
                raise InputError(f"noise: {name} is {getattr(self, name)} (0 or more)")
        if self.range_dropout > 1:
            raise InputError(f"noise: range_dropout is {self.range_dropout} (a share, 0 to 1)")


class RangeNoise:
    """Noise on LiDAR scans that depends on the seed and the scan's number only, not on which scans were asked for."""

    def __init__(self, settings: NoiseSettings, seed: int) -> None:
        self._settings = settings
        self._key = seed_of(seed, "lidar")

    def apply(self, ranges: FloatArray, number: int) -> FloatArray:
        """Return the (n,) ranges [m] of scan ``number`` as the sensor reports them; never negative."""
        settings = self._settings
        if settings.range_sigma == 0 and settings.range_dropout == 0:
            return ranges
        rng = np.random.default_rng([number, *self._key])
        noisy = np.maximum(ranges + settings.range_sigma * rng.standard_normal(len(ranges)), 0.0)
        noisy[rng.random(len(ranges)) < settings.range_dropout] = np.inf
        return noisy


def seed_of(seed: int, name: str) -> tuple[int, ...]:
    """Return the seed words of the stream ``name``; the same on every machine and in every run."""
    digest = hashlib.blake2b(name.encode(), digest_size=16).digest()
    return (seed, *np.frombuffer(digest, dtype="<u4").tolist())


def stream(seed: int, name: str) -> np.random.Generator:
    """Return a new random generator for the consumer ``name``, independent of those of other names."""
    return np.random.default_rng(seed_of(seed, name))
