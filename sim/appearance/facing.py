"""How shapes lie in their boxes: which side is up, and which way the front looks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.appearance.shape import Shape
from sim.world import World
from zavis_bt.types import FloatArray

_SQUARE = 1.25  # sides that differ by less count as equal
_REACH = np.arange(0.1, 1.6, 0.1)  # [m] looked ahead for walls
_PREFERENCE = 0.25  # [m] of free space that a less usual way to face must have more


def orientations(world: World, boxes: FloatArray, shapes: Sequence[Shape]) -> FloatArray:
    """Return (n, 3, 3) turns by right angles from the shapes' axes to those of their boxes.

    What has a front looks away from the nearest wall, as far as its proportions leave a choice.

    Args:
        world: Where walls are.
        boxes: (n, 7) middle of the base, length, width, height [m], yaw [rad].
        shapes: What is in each box.
    """
    turns = np.empty((len(boxes), 3, 3))
    for number, (box, shape) in enumerate(zip(boxes, shapes, strict=True)):
        ways = _ways(shape, box[3:6])
        if shape.has_front and len(ways) > 1:
            free = [_free_ahead(world, box, way) - _PREFERENCE * rank for rank, way in enumerate(ways)]
            turns[number] = ways[int(np.argmax(free))]
        else:
            turns[number] = ways[0]
    return turns


def _ways(shape: Shape, size: FloatArray) -> list[FloatArray]:
    """Return the ways a shape can lie in a box of this size, the usual one first."""
    length, width, height = size
    if shape.pose == "lying":
        order = np.argsort(-size, kind="stable")  # x along the longest side, z along the shortest
        if order[2] == 2 or size[2] < _SQUARE * size[order[2]]:
            order = np.array([0, 1, 2] if length >= width else [1, 0, 2])
        return [_axes(order)]
    if shape.pose == "longest up":
        tall = int(np.argmax(size))
        if height * _SQUARE >= size[tall]:
            tall = 2
        first, second = sorted((axis for axis in range(3) if axis != tall), key=lambda axis: -size[axis])
        return [_axes(np.array([first, second, tall]))]
    if shape.pose == "ahead":
        quarters = [1, 3, 0, 2] if max(length, width) < _SQUARE * min(length, width) else [1, 3]
        if shape.size[1] > shape.size[0] * _SQUARE and width > length * _SQUARE:
            quarters = [0, 2]  # as long from front to back as the shape is
        return [_quarter(turn) for turn in quarters]
    quarters = [0, 2] if length * _SQUARE >= width else [1, 3]
    if shape.has_front and max(length, width) < _SQUARE * min(length, width):
        quarters = [0, 2, 1, 3]
    return [_quarter(turn) for turn in quarters]


def _quarter(turn: int) -> FloatArray:
    """Return a turn about z by so many right angles."""
    cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]], dtype=np.float64)


def _axes(order: FloatArray) -> FloatArray:
    """Return the turn that takes the shape's axes to those of the box, in this order and without mirroring."""
    turn = np.zeros((3, 3))
    turn[order, range(3)] = 1.0
    if np.linalg.det(turn) < 0:
        turn[:, 1] = -turn[:, 1]
    return turn


def _free_ahead(world: World, box: FloatArray, way: FloatArray) -> float:
    """Return how far it is from a box's front to a wall, at most the last of `_REACH` [m]."""
    front = -way[:2, 1]  # the shape's front is at y = -1
    cos, sin = np.cos(box[6]), np.sin(box[6])
    ahead = np.array([cos * front[0] - sin * front[1], sin * front[0] + cos * front[1]])
    start = abs(front[0]) * box[3] / 2 + abs(front[1]) * box[4] / 2
    points = box[:2] + (start + _REACH)[:, None] * ahead
    cells = np.floor((points - world.grid.origin) / world.grid.resolution).astype(int)
    rows, cols = world.walls.shape
    inside = (cells >= 0).all(axis=1) & (cells[:, 0] < cols) & (cells[:, 1] < rows)
    blocked = ~inside
    blocked[inside] = world.walls[cells[inside, 1], cells[inside, 0]]
    return float(_REACH[int(np.argmax(blocked))] if blocked.any() else _REACH[-1] + 0.1)
