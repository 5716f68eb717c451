"""Dijkstra's algorithm over the cells of a grid in 16 directions."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.planning.steps import Steps

UNREACHED = 2**30
"""Length of the way to a cell to which there is none."""

# A step's length in 1/29 cell: 29 straight, 41 diagonal (√2 · 29 = 41.01), 65 a knight's move (√5 · 29 = 64.85).
_STRAIGHT, _DIAGONAL, _KNIGHT = 29, 41, 65
_RING = 128  # buckets: a power of two, more than the longest step
_ALL = 0xFFFF  # all steps are open


@njit(cache=True, nogil=True)
def dijkstra(open_steps: NDArray[np.uint16], moves: Steps, source: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Find the shortest ways from one cell to all others.

    Lengths are small integers, so a ring of buckets (R. Dial, 1969) is the queue. A cell whose way gets shorter is put
    into a bucket once more; the entry left behind no longer matches its length and is passed over. Where all steps are
    open no shortest way bends by more than one direction, so steps that bend more are not tried.

    Args:
        open_steps: From `zavis_bt.planning.steps.open_steps`.
        moves: The steps on the flat grid.
        source: Flat index of the cell to start from; -1 for none.

    Returns:
        For each cell the length of the way in 1/29 cell, or `UNREACHED`, and the cell before it, or -1.
    """
    size = len(open_steps)
    length = np.full(size, UNREACHED, dtype=np.int32)
    parent = np.full(size, -1, dtype=np.int32)
    if source < 0:
        return length, parent
    came = np.empty(size, dtype=np.int8)  # the step that led to a cell
    steps = np.where(moves.lengths > 2.0, _KNIGHT, np.where(moves.lengths > 1.2, _DIAGONAL, _STRAIGHT)).astype(np.int32)
    bucket = np.empty((_RING, 256), dtype=np.int32)
    filled = np.zeros(_RING, dtype=np.int64)
    offsets = moves.moves
    length[source], bucket[0, 0], filled[0] = 0, source, 1
    level, waiting = 0, 1
    while waiting > 0:
        slot = level & (_RING - 1)
        left = filled[slot]
        while left > 0:
            left -= 1
            cell = bucket[slot, left]
            if length[cell] != level:
                continue
            here, mask = length[cell], open_steps[cell]
            first, count = 0, 16
            if mask == _ALL and cell != source:
                first, count = came[cell] - 1, 3
            for direction in range(first, first + count):
                i = direction & 15
                if (mask >> i) & 1:  # nested, as numba makes slower code of `continue` here
                    other, new = cell + offsets[i], here + steps[i]
                    if new < length[other]:
                        length[other], parent[other], came[other] = new, cell, i
                        target = new & (_RING - 1)
                        if filled[target] == bucket.shape[1]:
                            bucket = _doubled(bucket)
                        bucket[target, filled[target]] = other
                        filled[target] += 1
                        waiting += 1
        waiting -= filled[slot]
        filled[slot] = 0
        level += 1
    return length, parent


@njit(cache=True, nogil=True)
def _doubled(bucket: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the buckets with room for twice as many cells."""
    wider = np.empty((bucket.shape[0], 2 * bucket.shape[1]), dtype=np.int32)
    wider[:, : bucket.shape[1]] = bucket
    return wider
