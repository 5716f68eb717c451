"""How shapes lie in their boxes: which side is up, and which way the front looks."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

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
    ways = [_ways(shape, tuple(box[3:6].tolist())) for box, shape in zip(boxes, shapes, strict=True)]
    turns = np.array([way[0] for way in ways]).reshape(-1, 3, 3)
    turned = [k for k, shape in enumerate(shapes) if shape.has_front and len(ways[k]) > 1]
    if turned:
        counts = [len(ways[k]) for k in turned]
        tried = np.array([way for k in turned for way in ways[k]])
        free = _free_ahead(world, np.repeat(boxes[turned], counts, axis=0), tried)
        free -= _PREFERENCE * np.concatenate([np.arange(count) for count in counts])
        begin = 0
        for k, count in zip(turned, counts, strict=True):
            turns[k] = ways[k][int(np.argmax(free[begin : begin + count]))]
            begin += count
    return turns


def _ways(shape: Shape, size: tuple[float, float, float]) -> list[FloatArray]:
    """Return the ways a shape can lie in a box of this size, the usual one first."""
    length, width, height = size
    if shape.pose == "lying":
        order = sorted(range(3), key=lambda axis: -size[axis])  # x along the longest side, z along the shortest
        if height < _SQUARE * size[order[2]]:
            order = [0, 1, 2] if length >= width else [1, 0, 2]
        return [_axes(*order)]
    if shape.pose == "longest up":
        tall = max(range(3), key=lambda axis: size[axis])
        tall = 2 if height * _SQUARE >= size[tall] else tall
        first, second = sorted((axis for axis in range(3) if axis != tall), key=lambda axis: -size[axis])
        return [_axes(first, second, tall)]
    if shape.pose == "ahead":
        quarters = [1, 3, 0, 2] if max(length, width) < _SQUARE * min(length, width) else [1, 3]
        if shape.size[1] > shape.size[0] * _SQUARE and width > length * _SQUARE:
            quarters = [0, 2]  # as long from front to back as the shape is
        return [_quarter(turn) for turn in quarters]
    quarters = [0, 2] if length * _SQUARE >= width else [1, 3]
    if shape.has_front and max(length, width) < _SQUARE * min(length, width):
        quarters = [0, 2, 1, 3]
    return [_quarter(turn) for turn in quarters]


@cache
def _quarter(turn: int) -> FloatArray:
    """Return a turn about z by so many right angles."""
    cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]], dtype=np.float64)


@cache
def _axes(first: int, second: int, third: int) -> FloatArray:
    """Return the turn that takes the shape's axes to these of the box, without mirroring."""
    turn = np.zeros((3, 3))
    turn[[first, second, third], range(3)] = 1.0
    if np.linalg.det(turn) < 0:
        turn[:, 1] = -turn[:, 1]
    return turn


def _free_ahead(world: World, boxes: FloatArray, ways: FloatArray) -> FloatArray:
    """Return (n,) how far it is from boxes' fronts to a wall for these turns, at most the last of `_REACH` [m]."""
    fronts = -ways[:, :2, 1]  # the shape's front is at y = -1
    cos, sin = np.cos(boxes[:, 6]), np.sin(boxes[:, 6])
    ahead = np.column_stack((cos * fronts[:, 0] - sin * fronts[:, 1], sin * fronts[:, 0] + cos * fronts[:, 1]))
    starts = (np.abs(fronts) * boxes[:, 3:5] / 2).sum(axis=1)
    points = boxes[:, None, :2] + (starts[:, None] + _REACH)[..., None] * ahead[:, None]
    cells = np.floor((points - world.grid.origin) / world.grid.resolution).astype(int)
    rows, cols = world.walls.shape
    inside = (cells >= 0).all(axis=2) & (cells[..., 0] < cols) & (cells[..., 1] < rows)
    blocked = ~inside
    blocked[inside] = world.walls[cells[inside][:, 1], cells[inside][:, 0]]
    return np.asarray(np.where(blocked.any(axis=1), _REACH[np.argmax(blocked, axis=1)], _REACH[-1] + 0.1))
