"""Driver of planar LiDARs over SCIP 2.0."""

from drivers.lidar.driver import ScipLidar, open_lidar
from drivers.lidar.settings import ScipSettings

__all__ = ["ScipLidar", "ScipSettings", "open_lidar"]
