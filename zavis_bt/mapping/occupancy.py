"""The occupancy grid: LiDAR scans fused into log-odds."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from zavis_bt.errors import InputError
from zavis_bt.mapping.scan_misses import LogOddsArray
from zavis_bt.mapping.scan_update import update
from zavis_bt.mapping.sensor_model import SensorModel
from zavis_bt.mapping.visible_area import Beams, trace
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, GridMap, LaserScan, Pose2D

_CHUNK = 64  # the grid grows by multiples of this many cells
_MAX_SIDE = 20_000  # cells, 1 km of 5 cm: a place further away than that is a fault of the localisation
_MARGIN = 3  # cells kept between what a scan touches and the border
_FREE_BELOW, _OCCUPIED_ABOVE = -0.2, 0.25  # log-odds; between them a cell is in dispute, so unknown
_UNKNOWN, _FREE, _OCCUPIED = np.int8(UNKNOWN), np.int8(FREE), np.int8(OCCUPIED)


class OccupancyGrid:
    """A map of free, occupied and unknown cells that grows with what is seen.

    Cell borders lie at multiples of the resolution (of a seeded map: in line with its cells).
    """

    def __init__(
        self,
        resolution: float = 0.05,
        max_range: float | None = None,
        model: SensorModel | None = None,
        no_return_is_free: bool = True,
    ) -> None:
        """Start with an empty map.

        Args:
            resolution: Side of a cell [m].
            max_range: Use scans only up to here [m]; None: up to the scan's own ``range_max``.
            model: Weights of hits and misses.
            no_return_is_free: Whether a beam without return leaves its way free up to the range in use; False for
                scanners that lose beams on glass or black surfaces, where it says nothing.

        Raises:
            InputError: The resolution is not positive.
        """
        if not resolution > 0:
            raise InputError(f"resolution: {resolution} m is not a cell size (greater than 0)")
        self._resolution = resolution
        self._max_range = math.inf if max_range is None else max_range
        self._model = model or SensorModel()
        self._no_return_is_free = no_return_is_free
        self._anchor = (0.0, 0.0)
        self._first = (0, 0)  # row and column of the array's cell [0, 0], counted from the anchor
        self._log_odds: LogOddsArray = np.zeros((0, 0), dtype=np.float32)
        self._dirty: tuple[int, int, int, int] | None = None  # rows and columns [first, end), counted from the anchor
        self._map = GridMap(_frozen(np.zeros((0, 0), dtype=np.int8)), resolution, self._anchor)

    def integrate(self, scan: LaserScan, sensor: Pose2D) -> None:
        """Fuse a scan.

        A broken beam (NaN or below ``range_min``) says nothing.

        Args:
            scan: Ranges in the sensor's frame.
            sensor: The sensor in the map at the time of the scan.

        Raises:
            InputError: The scan has no beams, no range ends its beams, its pose is not finite or lies so far from the
                rest of the map that there is no room for both.
        """
        limit = min(scan.range_max, self._max_range)
        ranges = np.ascontiguousarray(scan.ranges, dtype=np.float64)
        if not (len(ranges) and math.isfinite(limit)):
            raise InputError(f"scan: {len(ranges)} beams up to {limit} m (at least one, and a finite range_max)")
        if not math.isfinite(sensor.x + sensor.y + sensor.yaw):
            raise InputError(f"scan: taken from {sensor} (a finite pose)")
        step = float(scan.angle_increment) or 1e-9
        beams = trace(ranges, sensor.yaw + scan.angle_min, step, scan.range_min, limit, self._no_return_is_free)
        x, y = self._to_cells(sensor.x, sensor.y)
        self._include(*_bounds(x, y, beams, self._resolution))
        local_x, local_y = x - self._first[1], y - self._first[0]
        update(self._log_odds, local_x, local_y, beams, step, self._resolution, self._model)

    def clear(self, x: float, y: float, radius: float) -> None:
        """Make the cells free whose centres are closer than a radius: where the robot stands there is nothing else.

        Args:
            x: Map frame [m].
            y: Map frame [m].
            radius: Around the point [m].
        """
        col, row = self._to_cells(x, y)
        reach = radius / self._resolution
        first_row, end_row = math.floor(row - reach), math.ceil(row + reach) + 1
        first_col, end_col = math.floor(col - reach), math.ceil(col + reach) + 1
        self._include(first_row, end_row, first_col, end_col)
        rows = slice(first_row - self._first[0], end_row - self._first[0])
        cols = slice(first_col - self._first[1], end_col - self._first[1])
        dy = np.arange(first_row, end_row) + 0.5 - row
        dx = np.arange(first_col, end_col) + 0.5 - col
        inside = np.hypot(dy[:, None], dx) < reach - 1e-9
        self._log_odds[rows, cols][inside] = self._model.low

    def seed(self, grid: GridMap) -> None:
        """Replace everything by a saved map; its free and occupied cells count as well known.

        Args:
            grid: The map.

        Raises:
            InputError: Its resolution is not this grid's.
        """
        if not math.isclose(grid.resolution, self._resolution, rel_tol=1e-6):
            raise InputError(f"map: resolution {grid.resolution} m does not suit a grid of {self._resolution} m")
        self._anchor, self._first = (float(grid.origin[0]), float(grid.origin[1])), (0, 0)
        self._log_odds = np.zeros(grid.shape, dtype=np.float32)
        self._log_odds[grid.states == FREE] = self._model.low
        self._log_odds[grid.states == OCCUPIED] = self._model.high
        self._dirty = None
        self._map = GridMap(_frozen(grid.states.copy()), self._resolution, self._anchor, self._map.version + 1)

    @property
    def map(self) -> GridMap:
        """The map so far. Its version grows when a cell's state changed; earlier maps stay as they were."""
        if self._dirty is not None:
            self._refresh(self._dirty)
            self._dirty = None
        return self._map

    def _to_cells(self, x: float, y: float) -> tuple[float, float]:
        return (x - self._anchor[0]) / self._resolution, (y - self._anchor[1]) / self._resolution

    def _include(self, first_row: int, end_row: int, first_col: int, end_col: int) -> None:
        """Make room for these cells, counted from the anchor, and note that they may change."""
        rows, cols = self._log_odds.shape
        row, col = self._first
        if first_row < row or first_col < col or end_row > row + rows or end_col > col + cols:
            self._grow(first_row, end_row, first_col, end_col)
        if self._dirty is not None:
            r0, r1, c0, c1 = self._dirty
            first_row, end_row = min(r0, first_row), max(r1, end_row)
            first_col, end_col = min(c0, first_col), max(c1, end_col)
        self._dirty = first_row, end_row, first_col, end_col

    def _grow(self, first_row: int, end_row: int, first_col: int, end_col: int) -> None:
        old, (row, col) = self._log_odds, self._first
        if old.size:
            first_row, end_row = min(first_row, row), max(end_row, row + old.shape[0])
            first_col, end_col = min(first_col, col), max(end_col, col + old.shape[1])
        if max(end_row - first_row, end_col - first_col) > _MAX_SIDE:
            size = f"{(end_col - first_col) * self._resolution:.0f} × {(end_row - first_row) * self._resolution:.0f} m"
            raise InputError(f"map: {size} are too large (up to {_MAX_SIDE * self._resolution:.0f} m a side)")
        self._first = first_row // _CHUNK * _CHUNK, first_col // _CHUNK * _CHUNK
        rows = -(-(end_row - self._first[0]) // _CHUNK) * _CHUNK
        cols = -(-(end_col - self._first[1]) // _CHUNK) * _CHUNK
        self._log_odds = np.zeros((rows, cols), dtype=np.float32)
        top, left = row - self._first[0], col - self._first[1]
        if old.size:
            self._log_odds[top : top + old.shape[0], left : left + old.shape[1]] = old

    def _refresh(self, dirty: tuple[int, int, int, int]) -> None:
        origin = (
            self._anchor[0] + self._first[1] * self._resolution,
            self._anchor[1] + self._first[0] * self._resolution,
        )
        same_frame = self._map.shape == self._log_odds.shape and self._map.origin == origin
        states = self._map.states.copy() if same_frame else self._known_states(origin)
        rows = dirty[0] - self._first[0], dirty[1] - self._first[0]
        cols = dirty[2] - self._first[1], dirty[3] - self._first[1]
        if _classify(self._log_odds, rows, cols, _FREE_BELOW, _OCCUPIED_ABOVE, states):
            self._map = GridMap(_frozen(states), self._resolution, origin, self._map.version + 1)

    def _known_states(self, origin: tuple[float, float]) -> NDArray[np.int8]:
        """Return the present map's states in the frame of the grown grid."""
        states = np.full(self._log_odds.shape, _UNKNOWN, dtype=np.int8)
        col = round((self._map.origin[0] - origin[0]) / self._resolution)
        row = round((self._map.origin[1] - origin[1]) / self._resolution)
        rows, cols = self._map.shape
        if self._map.states.size:
            states[row : row + rows, col : col + cols] = self._map.states
        return states


def _frozen(states: NDArray[np.int8]) -> NDArray[np.int8]:
    states.setflags(write=False)
    return states


@njit(cache=True, nogil=True)
def _bounds(x: float, y: float, beams: Beams, cell: float) -> tuple[int, int, int, int]:
    """Return the rows and columns [first, end) a scan may touch."""
    cos, sin, reach, _ = beams
    x0, x1, y0, y1 = x, x, y, y
    for i in range(len(reach)):
        end_x, end_y = x + reach[i] / cell * cos[i], y + reach[i] / cell * sin[i]
        x0, x1, y0, y1 = min(x0, end_x), max(x1, end_x), min(y0, end_y), max(y1, end_y)
    return (
        math.floor(y0) - _MARGIN,
        math.ceil(y1) + _MARGIN,
        math.floor(x0) - _MARGIN,
        math.ceil(x1) + _MARGIN,
    )


@njit(cache=True, nogil=True)
def _classify(
    log_odds: LogOddsArray,
    rows: tuple[int, int],
    cols: tuple[int, int],
    free_below: float,
    occupied_above: float,
    states: NDArray[np.int8],
) -> bool:
    """Bring the states of the cells in [first, end) up to date and return whether any of them changed."""
    low, high = np.float32(free_below), np.float32(occupied_above)
    changed = False
    for row in range(rows[0], rows[1]):
        values, old = log_odds[row, cols[0] : cols[1]], states[row, cols[0] : cols[1]]
        changes = np.int8(0)
        for i in range(len(values)):
            value = values[i]
            state = _FREE if value < low else _UNKNOWN
            state = _OCCUPIED if value > high else state
            changes |= state ^ old[i]
            old[i] = state
        changed |= changes != 0
    return changed
