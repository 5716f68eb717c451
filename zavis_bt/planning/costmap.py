"""Where a robot fits, and where it would rather be."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.planning.distance_field import DistanceField, distance_field
from zavis_bt.planning.grid_kernels import (
    Body,
    body_fits,
    clearances,
    line_fits,
    nearest_passable,
    polyline_fits,
)
from zavis_bt.planning.steps import open_steps
from zavis_bt.types import OCCUPIED, UNKNOWN, FloatArray, Footprint, GridMap, Pose2D

UnknownRule = Literal["avoid", "allow", "obstacle"]
_UNKNOWN_RULES: tuple[UnknownRule, ...] = ("avoid", "allow", "obstacle")

_RECTANGLE_MARGIN = 0.02  # beyond the inscribed radius, for headings that are not quite along the passage [m]
_COMFORT = 0.3  # clearance beyond the radius from which more is not better [m]
_COMFORT_WEIGHT = 0.3  # what a metre costs extra where the robot only just fits
_NEAR = 0.12  # clearance beyond the radius below which driving is slow [m]
_NEAR_WEIGHT = 0.6  # what a metre costs extra there at most, on top
_TIGHT_WEIGHT = 2.0  # what a metre costs extra where a rectangle fits but cannot turn on the spot


class Costmap:
    """A grid seen by a robot: distances to obstacles, passable cells, and a price for every metre.

    A cell is passable if its centre is at least ``radius`` from the centre of every obstacle cell (the costmap
    convention). For a disc that is the disc's radius. For a rectangle it is its inscribed radius and a small margin, so
    that no passage it can drive through straight is forbidden, at a price that keeps paths where it can also turn
    (``turning_radius``, the circumscribed one) wherever there is room.

    Distances and the cost are computed when first asked for. All arrays are read-only.
    """

    def __init__(
        self, grid: GridMap, footprint: Footprint, *, unknown: UnknownRule = "avoid", unknown_cost: float = 2.0
    ) -> None:
        """Describe the costmap.

        Args:
            grid: Map.
            footprint: The robot's outline.
            unknown: Unknown cells, and all that is outside of the grid: ``avoid`` them (the robot's middle stays out
                of them, its outline may overlap them), ``allow`` them at a price inside the grid, or take them for an
                ``obstacle``.
            unknown_cost: What a metre over unknown cells costs extra if they are allowed.

        Raises:
            InputError: No such rule for unknown cells.
        """
        if unknown not in _UNKNOWN_RULES:
            raise InputError(f"unknown: no rule '{unknown}'{did_you_mean(unknown, _UNKNOWN_RULES)}")
        self.grid, self.footprint = grid, footprint
        self.radius = footprint.inscribed_radius + (0.0 if footprint.disc else _RECTANGLE_MARGIN)
        """Clearance from which a cell is passable [m]."""
        self.turning_radius = footprint.circumscribed_radius
        """Clearance from which the robot can turn on the spot whatever its outline [m]."""
        self.body = Body.of(footprint, grid.resolution)
        """The outline in cells."""
        self._unknown, self._unknown_cost = unknown, unknown_cost

    @cached_property
    def field(self) -> DistanceField:
        """Distances to the nearest obstacle in cells, as the kernels want them."""
        closed = self._unknown == "obstacle"
        return distance_field(self.grid.states != 0 if closed else self.grid.states == OCCUPIED, closed)

    @cached_property
    def distance(self) -> NDArray[np.float32]:
        """(rows, cols) distance from each cell's centre to that of the nearest obstacle cell [m]; inf if none."""
        return _frozen(self.field.distance * np.float32(self.grid.resolution))

    @cached_property
    def barred(self) -> NDArray[np.bool_]:
        """(rows, cols) cells where the robot's middle may not be, whatever their clearance: unknown ones."""
        if self._unknown == "avoid":
            return _frozen(self.grid.states == UNKNOWN)
        return _frozen(np.zeros(self.grid.shape, dtype=np.bool_))

    @cached_property
    def passable(self) -> NDArray[np.bool_]:
        """(rows, cols) cells where the robot fits."""
        limit = self.radius / self.grid.resolution - 1e-5
        return _frozen((self.field.distance >= np.float32(limit)) & ~self.barred)

    @cached_property
    def open_steps(self) -> NDArray[np.uint16]:
        """Which of 16 steps lead from a passable cell to a passable one; flat, see `zavis_bt.planning.steps`."""
        return _frozen(open_steps(self.passable))

    @cached_property
    def tight(self) -> NDArray[np.bool_]:
        """(rows, cols) passable cells where a rectangle cannot turn on the spot; none for a disc."""
        limit = np.float32(self.turning_radius / self.grid.resolution - 1e-5)
        return _frozen(self.passable & (self.field.distance < limit))

    @cached_property
    def cost(self) -> NDArray[np.float32]:
        """(rows, cols) price of a metre: 1 in the open, more near obstacles, inf where not passable."""
        cost = np.ones(self.grid.shape, dtype=np.float32)
        for weight, reach in ((_COMFORT_WEIGHT, _COMFORT), (_NEAR_WEIGHT, _NEAR)):
            lack = np.clip((self.radius + reach - self.distance) / np.float32(reach), 0.0, 1.0)
            cost += weight * lack * lack
        if self.turning_radius > self.radius:
            tight = (self.turning_radius - self.distance) / (self.turning_radius - self.radius)
            cost += _TIGHT_WEIGHT * np.clip(tight, 0.0, 1.0)
        if self._unknown == "allow":
            cost += np.where(self.grid.states == UNKNOWN, self._unknown_cost, 0.0)
        return _frozen(np.where(self.passable, cost, np.inf).astype(np.float32))

    def to_uv(self, points: FloatArray) -> FloatArray:
        """Return (n, 2) points [m] in cells: (u, v) = (col, row) at a cell's centre."""
        uv: FloatArray = (np.asarray(points, dtype=np.float64) - self.grid.origin) / self.grid.resolution - 0.5
        return uv

    def to_points(self, uv: FloatArray) -> FloatArray:
        """Return (n, 2) positions in cells as map points [m]."""
        points: FloatArray = (uv + 0.5) * self.grid.resolution + self.grid.origin
        return points

    def clearance(self, points: FloatArray) -> FloatArray:
        """Return the (n,) distances from (n, 2) points to the nearest obstacle cell's centre [m]; exact in between."""
        uv = self.to_uv(np.reshape(points, (-1, 2)))
        return np.asarray(clearances(self.field, uv)) * self.grid.resolution

    def fits(self, points: FloatArray, *, slack: float = 0.0) -> NDArray[np.bool_]:
        """Tell where the robot's middle may be.

        Args:
            points: (n, 2) [m].
            slack: How much nearer than ``radius`` obstacles may be [m].

        Returns:
            (n,) whether the point has the clearance and is not in a barred cell nor outside of the grid.
        """
        points = np.reshape(np.asarray(points, dtype=np.float64), (-1, 2))
        cells = self.grid.to_cells(points)
        rows, cols = self.grid.shape
        inside = (cells >= 0).all(axis=1) & (cells[:, 0] < rows) & (cells[:, 1] < cols)
        cells = np.where(inside[:, None], cells, 0)
        clear = self.clearance(points) >= self.radius - slack - 1e-6
        free: NDArray[np.bool_] = inside & clear & ~self.barred[cells[:, 0], cells[:, 1]]
        return free

    def line_fits(self, start: tuple[float, float], end: tuple[float, float]) -> bool:
        """Tell whether the robot can move on the straight line between two points [m]."""
        (u0, v0), (u1, v1) = self.to_uv(np.array([start, end]))
        return bool(line_fits(self.field, self.barred, self.radius / self.grid.resolution, u0, v0, u1, v1))

    def path_fits(self, points: FloatArray) -> bool:
        """Tell whether the robot can move along the (n, 2) points [m]; steps between passable cells always fit."""
        radius = (self.radius - self.slack) / self.grid.resolution
        return bool(polyline_fits(self.field, self.barred, radius, self.to_uv(points)))

    @property
    def slack(self) -> float:
        """How far a diagonal step between passable cells can come nearer to an obstacle than ``radius`` [m]."""
        step = self.grid.resolution / math.sqrt(2)
        return self.radius - math.sqrt(max(self.radius**2 - step * step, 0.0)) + 1e-6

    def pose_fits(self, pose: Pose2D) -> bool:
        """Tell whether the outline at this pose holds no centre of an obstacle cell."""
        ((u, v),) = self.to_uv(np.array([[pose.x, pose.y]]))
        return bool(body_fits(self.field, self.body, u, v, pose.yaw))

    def nearest_passable(self, x: float, y: float, within: float) -> tuple[int, int] | None:
        """Return the passable cell ``(row, col)`` whose centre is nearest to a point, or None if none is within [m]."""
        ((u, v),) = self.to_uv(np.array([[x, y]]))
        row, col = nearest_passable(self.passable, u, v, within / self.grid.resolution)
        return (int(row), int(col)) if row >= 0 else None


class Costmaps:
    """The costmap of a grid that changes: computed anew only for a new version."""

    def __init__(self, grid: Callable[[], GridMap], footprint: Footprint) -> None:
        """Say whose costmap.

        Args:
            grid: Returns the current grid.
            footprint: The robot's outline.
        """
        self._grid, self._footprint = grid, footprint
        self._latest: Costmap | None = None

    @property
    def version(self) -> int:
        """Version of the current grid."""
        return self._grid().version

    @property
    def current(self) -> Costmap:
        """The costmap of the current grid."""
        grid, latest = self._grid(), self._latest
        if latest is None or (latest.grid is not grid and latest.grid.version != grid.version):
            latest = self._latest = Costmap(grid, self._footprint)
        return latest


def _frozen(array: NDArray[Any]) -> NDArray[Any]:
    array.setflags(write=False)
    return array
