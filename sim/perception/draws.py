"""Random numbers that belong to what they are drawn for, not to the order in which they are drawn.

Every number is a hash of the seed and of keys: which question, which instance, which text, which frame. So a frame is
judged alike whatever was judged before it, and two judgements of one instance can share a part of their luck.
"""

from __future__ import annotations

import hashlib
import math
from functools import lru_cache

import numpy as np
from numba import vectorize
from numpy.typing import NDArray

from zavis_bt.types import FloatArray, RgbdFrame

Keys = NDArray[np.uint64] | int


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
        return np.atleast_1d(_unit(self._state(question, keys)))

    def normal(self, question: str, *keys: Keys) -> FloatArray:
        """Return standard normal numbers, one for each combination of keys."""
        return np.atleast_1d(_normal(self._state(question, keys)))

    def _state(self, question: str, keys: tuple[Keys, ...]) -> NDArray[np.uint64]:
        state: NDArray[np.uint64] = _mix(np.uint64(self._seed), np.uint64(key_of(question)))
        for key in keys:
            state = _mix(state, key if isinstance(key, np.ndarray) else np.uint64(key))
        return state


_ufunc = vectorize(cache=True)


@_ufunc
def _mix(state: np.uint64, key: np.uint64) -> np.uint64:
    """Return SplitMix64's next output after the state was changed by a key."""
    state = (state ^ key) + np.uint64(0x9E3779B97F4A7C15)  # 2⁶⁴ over the golden ratio
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return state ^ (state >> np.uint64(31))


@_ufunc
def _unit(state: np.uint64) -> float:
    """Return a number in [0, 1) of a state's upper 53 bits."""
    return (state >> np.uint64(11)) * 2.0**-53


@_ufunc
def _normal(state: np.uint64) -> float:
    """Return a standard normal number of a state: Box-Muller on its two halves."""
    first = ((state >> np.uint64(32)) + 0.5) * 2.0**-32
    second = (state & np.uint64(0xFFFFFFFF)) * 2.0**-32
    return math.sqrt(-2.0 * math.log(first)) * math.cos(2.0 * math.pi * second)
