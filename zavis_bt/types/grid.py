"""Occupancy maps as values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types.motion import FloatArray

UNKNOWN, FREE, OCCUPIED = -1, 0, 100  # cell states of a grid, as in nav_msgs/OccupancyGrid


@dataclass(frozen=True, slots=True)
class GridMap:
    """An immutable occupancy map: what map_server files hold, planners read and viewers draw."""

    states: NDArray[np.int8]
    """(rows, cols): `UNKNOWN`, `FREE` or `OCCUPIED`; row 0 at the smallest y; read-only."""
    resolution: float
    """Side of a cell [m]."""
    origin: tuple[float, float]
    """Map coordinates of the outer corner of cell [0, 0] [m]."""
    version: int = 0
    """Grows whenever the states change, so that readers know when to redo work."""

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        return self.states.shape[0], self.states.shape[1]

    def to_cells(self, points: FloatArray) -> NDArray[np.intp]:
        """Return (n, 2) ``[row, col]`` of (n, 2) points; cells may lie outside the grid."""
        scaled = (np.asarray(points, dtype=np.float64) - self.origin) / self.resolution
        return np.floor(scaled).astype(np.intp)[:, ::-1]

    def to_points(self, cells: NDArray[np.intp]) -> FloatArray:
        """Return the (n, 2) centres [m] of (n, 2) cells ``[row, col]``."""
        return (np.asarray(cells, dtype=np.float64)[:, ::-1] + 0.5) * self.resolution + self.origin

    def state_at(self, x: float, y: float) -> int:
        """Return the state of the cell that holds the point; `UNKNOWN` outside the grid."""
        row, col = self.to_cells(np.array([[x, y]]))[0]
        inside = 0 <= row < self.states.shape[0] and 0 <= col < self.states.shape[1]
        return int(self.states[row, col]) if inside else UNKNOWN
