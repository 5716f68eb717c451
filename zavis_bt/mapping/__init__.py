"""What is where: occupancy grid, frontiers, lines of sight, semantic map, and their files."""

from zavis_bt.mapping.association import AssociationSettings
from zavis_bt.mapping.carmen import CarmenScan, read_carmen
from zavis_bt.mapping.frontiers import Frontier, find_frontiers, frontier_goal
from zavis_bt.mapping.line_of_sight import clear_line, visible_from
from zavis_bt.mapping.map_server import load_map, save_map
from zavis_bt.mapping.mapper import Mapper, MapperSettings
from zavis_bt.mapping.occupancy import OccupancyGrid
from zavis_bt.mapping.semantic import SemanticMap
from zavis_bt.mapping.semantic_file import decode_landmarks, encode_landmarks
from zavis_bt.mapping.sensor_model import SensorModel
from zavis_bt.mapping.views import Views

__all__ = [
    "AssociationSettings",
    "CarmenScan",
    "Frontier",
    "Mapper",
    "MapperSettings",
    "OccupancyGrid",
    "SemanticMap",
    "SensorModel",
    "Views",
    "clear_line",
    "decode_landmarks",
    "encode_landmarks",
    "find_frontiers",
    "frontier_goal",
    "load_map",
    "read_carmen",
    "save_map",
    "visible_from",
]
