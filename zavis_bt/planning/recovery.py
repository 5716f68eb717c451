"""Ways out for a robot that cannot go on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from zavis_bt.planning.costmap import Costmap
from zavis_bt.planning.grid_kernels import largest_fit
from zavis_bt.types import Pose2D

_STEP = 0.02  # [m]
_DIRECTIONS = 24
_REACH = 1.5  # directions are compared as far as this [m]


@dataclass(frozen=True, slots=True)
class BackUpMove:
    """Reverse straight."""

    distance: float
    """[m]"""


@dataclass(frozen=True, slots=True)
class TurnMove:
    """Turn on the spot to where there is most room."""

    heading: float
    """Yaw in the map [rad]."""


def free_distance(costmap: Costmap, pose: Pose2D, direction: float, limit: float) -> float:
    """Return how far the outline can slide without turning.

    Args:
        costmap: What is mapped.
        pose: The robot.
        direction: Of the motion, in the map [rad].
        limit: Largest distance of interest [m].

    Returns:
        Distance [m]. An outline that overlaps an obstacle already may move as long as it comes no deeper into one.
    """
    cos, sin = math.cos(direction), math.sin(direction)
    allowed = _fit(costmap, pose.x, pose.y, pose.yaw) - 1e-3
    for i in range(1, math.ceil(limit / _STEP) + 1):
        along = min(i * _STEP, limit)
        if _fit(costmap, pose.x + along * cos, pose.y + along * sin, pose.yaw) < min(allowed, 1.0 - 1e-6):
            return (i - 1) * _STEP
    return limit


def choose_recovery(costmap: Costmap, pose: Pose2D, *, distance: float = 0.3) -> BackUpMove | TurnMove:
    """Choose a way out: back up if at least half of the distance is free, else turn to the freest direction.

    Args:
        costmap: What is mapped.
        pose: The robot.
        distance: How far to back up at most [m].
    """
    behind = free_distance(costmap, pose, pose.yaw + math.pi, distance)
    if behind >= distance / 2:
        return BackUpMove(behind)
    turns = [i * math.tau / _DIRECTIONS for i in range(_DIRECTIONS)]
    turns.sort(key=lambda turn: abs(math.remainder(turn, math.tau)))  # of equal directions the nearest wins
    free = [_room(costmap, pose, pose.yaw + turn) for turn in turns]
    return TurnMove(math.remainder(pose.yaw + turns[int(np.argmax(free))], math.tau))


def _room(costmap: Costmap, pose: Pose2D, heading: float) -> float:
    return free_distance(costmap, Pose2D(pose.x, pose.y, heading), heading, _REACH)


def _fit(costmap: Costmap, x: float, y: float, yaw: float) -> float:
    (x0, y0), resolution = costmap.grid.origin, costmap.grid.resolution
    u, v = (x - x0) / resolution - 0.5, (y - y0) / resolution - 0.5
    return float(largest_fit(costmap.field, costmap.body, u, v, yaw))
