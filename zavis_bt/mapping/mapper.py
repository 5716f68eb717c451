"""What the robot knows of its surroundings, kept up to date from its scans."""

from __future__ import annotations

from dataclasses import dataclass

from zavis_bt.mapping.occupancy import OccupancyGrid
from zavis_bt.mapping.semantic import SemanticMap
from zavis_bt.mapping.views import Views
from zavis_bt.types import GridMap, LaserScan, Pose2D, RobotSpec, wrap_angle


@dataclass(frozen=True, slots=True)
class MapperSettings:
    """When a scan is worth fusing."""

    min_distance: float = 0.05
    """The robot moved this far since the last fused scan [m]…"""
    min_rotation: float = 0.052
    """… or turned this far [rad] …"""
    max_interval: float = 1.0
    """… or this much time passed [s]."""
    max_range: float | None = None
    """Use scans only up to here [m]; None: up to their own ``range_max``."""
    no_return_is_free: bool = True
    """Whether a beam without return leaves its way free."""


class Mapper:
    """Fuses scans into the occupancy grid and holds the semantic map."""

    def __init__(self, spec: RobotSpec, resolution: float = 0.05, settings: MapperSettings | None = None) -> None:
        """Start with empty maps.

        Args:
            spec: The robot; its LiDAR's mount and its footprint are used.
            resolution: Side of a cell of the grid [m].
            settings: When a scan is worth fusing.
        """
        self._settings = settings or MapperSettings()
        self._mount = spec.lidar.mount
        self._radius = spec.footprint.inscribed_radius
        self._occupancy = OccupancyGrid(
            resolution, max_range=self._settings.max_range, no_return_is_free=self._settings.no_return_is_free
        )
        self._semantic = SemanticMap()
        self.views = Views()
        """From where the camera looked."""
        self._fused: tuple[Pose2D, float] | None = None

    @property
    def grid(self) -> GridMap:
        """The occupancy map so far; compare ``version``."""
        return self._occupancy.map

    @property
    def semantic(self) -> SemanticMap:
        """The landmarks so far."""
        return self._semantic

    def update(self, scan: LaserScan | None, pose: Pose2D) -> bool:
        """Fuse a scan if it can tell something new; cheap otherwise.

        Args:
            scan: The latest scan, or None if there was none yet.
            pose: The base in the map at the time of the scan.

        Returns:
            Whether the scan was fused.
        """
        if scan is None or not self._is_news(scan, pose):
            return False
        self._occupancy.integrate(scan, pose @ self._mount)
        self._occupancy.clear(pose.x, pose.y, self._radius)
        self._fused = pose, scan.stamp
        return True

    def seed(self, grid: GridMap, semantic: SemanticMap | None = None) -> None:
        """Go on from saved maps instead of empty ones.

        Args:
            grid: The occupancy map.
            semantic: The semantic map; None leaves the present one.

        Raises:
            InputError: The grid's resolution is another one.
        """
        self._occupancy.seed(grid)
        self._semantic = semantic or self._semantic
        self._fused = None

    def _is_news(self, scan: LaserScan, pose: Pose2D) -> bool:
        if self._fused is None:
            return True
        last, stamp = self._fused
        if scan.stamp == stamp:
            return False
        moved = last.distance(pose) > self._settings.min_distance
        turned = abs(wrap_angle(pose.yaw - last.yaw)) > self._settings.min_rotation
        return moved or turned or scan.stamp - stamp >= self._settings.max_interval
