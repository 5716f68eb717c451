"""How much is found of small and of large things."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from zavis_bt.perception.evaluation.matching import Pairs, covered
from zavis_bt.perception.evaluation.tables import Table
from zavis_bt.types import FloatArray

SIZES = (0.0, 16.0, 24.0, 32.0, 48.0, 64.0, 96.0, 128.0, 192.0, 256.0, math.inf)
"""Borders of the classes of size: the square root of a box's area [px of the full image]."""


@dataclass(frozen=True, slots=True)
class SizeRecall:
    """What is found of things of one size."""

    least: float
    """The square root of the box's area is at least this [px]."""
    most: float
    """And less than this [px]; may be infinite."""
    truths: int
    recall: float
    """By boxes of whatever label; NaN without things."""


def size_classes(boxes: FloatArray) -> NDArray[np.intp]:
    """Return the number of the class of size in `SIZES` for (n, 4) boxes."""
    sides = np.maximum(boxes[:, 2:] - boxes[:, :2], 0.0)
    classes: NDArray[np.intp] = np.digitize(np.sqrt(sides[:, 0] * sides[:, 1]), SIZES[1:-1])
    return classes


def recall_by_size(truths: Table, pairs: Pairs) -> tuple[SizeRecall, ...]:
    """Return the share of things that some box covers with IoU > 0.5, by size. Ignored things do not count."""
    found, size = covered(truths, pairs), size_classes(truths.box)
    rows = []
    for k, (least, most) in enumerate(pairwise(SIZES)):
        members = found[(size == k) & ~truths.ignored]
        rows.append(SizeRecall(least, most, len(members), float(members.mean()) if len(members) else math.nan))
    return tuple(rows)
