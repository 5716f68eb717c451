"""Boxes that hold no whole thing: pieces of wall and floor, and fragments of things."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.clip.captions import EMPTY, PART

_FRAGMENTS = 0.45  # share that lies on a thing on purpose
_TRIES = 12  # for each box
_LEAST_SIDE = 12.0  # [px at 640 px width]
_MOST_IOU = 0.3  # with any thing
_COVERED = 0.02  # share of the box from which on it does not count as empty


def draw_backgrounds(
    things: NDArray[np.float64], size: tuple[int, int], count: int, rng: np.random.Generator
) -> list[tuple[NDArray[np.float64], str]]:
    """Return boxes that overlap every thing by less than an IoU of 0.3, each with what it shows.

    Args:
        things: (n, 4) boxes of all things, also of those that do not count [px].
        size: Width and height of the image [px].
        count: How many are wanted; fewer if there is no room.
        rng: Source of the draws.

    Returns:
        Boxes (4,) [px] with `EMPTY` or `PART`.
    """
    found: list[tuple[NDArray[np.float64], str]] = []
    for _ in range(count * _TRIES):
        if len(found) == count:
            break
        fragment = len(things) > 0 and rng.random() < _FRAGMENTS
        box = _within(things[rng.integers(len(things))], rng) if fragment else _anywhere(size, rng)
        box = np.clip(box, 0, (*size, *size))
        sides = box[2:] - box[:2]
        if sides.min() < _LEAST_SIDE * size[0] / 640:
            continue
        common = _intersections(box, things)
        unions = sides.prod() + (things[:, 2:] - things[:, :2]).prod(axis=1) - common
        if (common / unions).max(initial=0.0) < _MOST_IOU:
            found.append((box, EMPTY if common.max(initial=0.0) < _COVERED * sides.prod() else PART))
    return found


def _within(thing: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Return a box on a part of a thing, reaching a little beyond it."""
    sides = thing[2:] - thing[:2]
    part = sides * rng.uniform(0.15, 0.8, 2)
    corner = thing[:2] + rng.uniform(-0.3 * part, sides - 0.7 * part)
    return np.concatenate([corner, corner + part])


def _anywhere(size: tuple[int, int], rng: np.random.Generator) -> NDArray[np.float64]:
    side = math.exp(rng.uniform(math.log(size[0] / 40), math.log(size[0] / 1.6)))
    shape = math.exp(rng.normal(0, 0.25))
    part = np.minimum([side * shape, side / shape], np.asarray(size) * 0.93)
    corner = rng.uniform(-0.1 * part, np.asarray(size) - 0.9 * part)
    return np.concatenate([corner, corner + part])


def _intersections(box: NDArray[np.float64], things: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = np.maximum(box[:2], things[:, :2]), np.minimum(box[2:], things[:, 2:])
    common: NDArray[np.float64] = np.clip(high - low, 0, None).prod(axis=1)
    return common
