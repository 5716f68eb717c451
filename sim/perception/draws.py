"""Random numbers that belong to what they are drawn for, not to the order in which they are drawn.

Every number is a hash of the seed and of keys: which question, which instance, which text, which frame. So a frame is
judged alike whatever was judged before it, and two judgements of one instance can share a part of their luck.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import FloatArray, RgbdFrame

Keys = NDArray[np.uint64] | int
_STEP = np.uint64(0x9E3779B97F4A7C15)  # 2⁶⁴ over the golden ratio, the increment of SplitMix64


@lru_cache(maxsize=65536)
def key_of(*words: str) -> int:
    """Return a 64-bit key of words, the same on every machine."""
    return int.from_bytes(hashlib.blake2b("\0".join(words).encode(), digest_size=8).digest(), "little")


def keys_of(words: list[str]) -> NDArray[np.uint64]:
    """Return the keys (n,) of n words."""
    return np.array([key_of(word) for word in words], dtype=np.uint64)


def frame_key(frame: RgbdFrame) -> int:
    """Return a key of when and from where a frame was taken."""
    content = np.float64(frame.stamp).tobytes() + np.ascontiguousarray(frame.transform_camera_to_map).tobytes()
    return int.from_bytes(hashlib.blake2b(content, digest_size=8).digest(), "little")


class Draws:
    """A source of keyed random numbers."""

    def __init__(self, rng: np.random.Generator) -> None:
        """Take a seed from a generator; afterwards the generator is not used."""
        self._seed = int(rng.integers(2**63))

    def uniform(self, question: str, *keys: Keys) -> FloatArray:
        """Return numbers in [0, 1), one for each combination of keys; arrays of keys are broadcast."""
        state = np.atleast_1d(np.asarray(self._seed ^ key_of(question), dtype=np.uint64))
        for key in keys:
            state = _mix(state ^ np.asarray(key, dtype=np.uint64))
        return np.asarray((_mix(state) >> np.uint64(11)) * 2.0**-53)

    def normal(self, question: str, *keys: Keys) -> FloatArray:
        """Return standard normal numbers, one for each combination of keys (Box-Muller)."""
        radius = np.sqrt(-2.0 * np.log1p(-self.uniform(question, *keys)))
        return np.asarray(radius * np.cos(2.0 * np.pi * self.uniform(question + "'", *keys)))


def _mix(state: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return SplitMix64's output for each state."""
    state = state + _STEP
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray(state ^ (state >> np.uint64(31)))
