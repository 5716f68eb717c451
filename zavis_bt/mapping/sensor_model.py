"""What a LiDAR reading is worth."""

from __future__ import annotations

from typing import NamedTuple


class SensorModel(NamedTuple):
    """What a reading is worth, in log-odds of a cell being occupied."""

    hit: float = 0.9
    """For the cell a beam ended in."""
    miss: float = -0.4
    """For a cell the beams leave no room to hide in, or that a beam went through."""
    gap: float = -0.3
    """For cells between beams further apart than a cell, unless something was seen there: a thin thing between two
    beams is no less there for having been missed."""
    gap_low: float = -0.6
    """Least value by `gap` alone: one hit outweighs it."""
    surface: float = 0.3
    """Floor for cells between neighbouring hits on one surface, unless they were seen to be free: a wall whose cells
    are only hit here and there, being far or seen at a flat angle, is closed all the same until a closer look."""
    low: float = -2.0
    """Least value, so that what changes is noticed soon."""
    high: float = 3.5
    """Greatest value."""
