"""What is where: occupancy grid, frontiers, semantic map, and their files."""

from zavis_bt.mapping.map_server import load_map, save_map

__all__ = ["load_map", "save_map"]
