"""A room known without the simulator, as boxes, and the robot that stands in it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.world import World
from zavis_bt.types import FREE, OCCUPIED, FloatArray, GridMap, Pose2D

WIDTH, DEPTH = 12.0, 10.0  # of the free floor, its lower left corner at (0, 0) [m]
_CELL, _WALL = 0.05, 2  # [m], [cells]


class Block(NamedTuple):
    x0: float
    y0: float
    x1: float
    y1: float


PILLARS = (Block(8.0, 2.0, 8.5, 2.3), Block(4.0, 1.5, 4.3, 2.5), Block(7.5, 7.0, 8.0, 8.0), Block(2.0, 5.0, 2.2, 5.2))
_WALLS = (
    Block(-1.0, -1.0, 0.0, DEPTH + 1),
    Block(WIDTH, -1.0, WIDTH + 1, DEPTH + 1),
    Block(-1.0, -1.0, WIDTH + 1, 0.0),
    Block(-1.0, DEPTH, WIDTH + 1, DEPTH + 1),
)

MIDDLE = Pose2D(6.0, 5.0, 0.3)
"""Metres of free floor all around."""
BY_THE_WALL = Pose2D(6.0, 0.4, 0.0)
"""The wall to the right is nearer than the LiDAR can measure, what lies ahead is farther."""
BEFORE_A_WALL = Pose2D(WIDTH - 0.45, 5.0, 0.0)
"""The outline is 0.2 m from the wall ahead."""
FACING_THE_WALL = Pose2D(WIDTH - 3.0, 5.0, 0.0)

ROBOT = """\
format: zavis-robot/1
name: conformance
footprint: {radius: 0.25}
limits:
  max_linear: 0.6
  max_reverse: 0.3
  max_angular_deg: 90
  linear_acceleration: 0.8
  angular_acceleration_deg: 240
lidar: {beams: 271, field_of_view_deg: 270, range_min: 0.5, range_max: 5, rate: 20, x: 0.1, height: 0.4}
pan_tilt:
  pan_min_deg: -75
  pan_max_deg: 75
  tilt_min_deg: -40
  tilt_max_deg: 30
  max_rate_deg: 150
  max_acceleration_deg: 900
camera: {image: [64, 48], horizontal_fov_deg: 60, x: 0.05, height: 1.0, depth_min: 0.3, depth_max: 4, rate: 10}
"""


def room() -> World:
    """Return the room as the simulator takes it."""
    rows, cols = round(DEPTH / _CELL), round(WIDTH / _CELL)
    occupied = np.pad(np.zeros((rows, cols), dtype=np.bool_), _WALL, constant_values=True)
    for block in PILLARS:
        x0, y0, x1, y1 = (round(edge / _CELL) + _WALL for edge in block)
        occupied[y0:y1, x0:x1] = True
    corner = -_WALL * _CELL
    return World("room", GridMap(np.where(occupied, OCCUPIED, FREE).astype(np.int8), _CELL, (corner, corner)), 2.5)


def distances(sensor: Pose2D, angles: FloatArray) -> FloatArray:
    """Return how far it is to the nearest block along directions in the sensor's frame, (n,) [m]: the slab method."""
    heading = sensor.yaw + angles
    with np.errstate(divide="ignore"):
        over_x, over_y = 1 / np.cos(heading), 1 / np.sin(heading)
    nearest = np.full(len(angles), math.inf)
    for block in (*PILLARS, *_WALLS):
        x = np.sort(np.stack(((block.x0 - sensor.x) * over_x, (block.x1 - sensor.x) * over_x)), axis=0)
        y = np.sort(np.stack(((block.y0 - sensor.y) * over_y, (block.y1 - sensor.y) * over_y)), axis=0)
        enter, leave = np.maximum(x[0], y[0]), np.minimum(x[1], y[1])
        hit = (enter <= leave) & (enter > 0)
        nearest[hit] = np.minimum(nearest[hit], enter[hit])
    return nearest
