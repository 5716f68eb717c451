"""A small world to begin one's own with."""

from __future__ import annotations

import re
from pathlib import Path

from sim.world import Furniture
from sim.worlds.paint import FloorPlan
from zavis_bt.errors import InputError
from zavis_bt.mapping.map_server import save_map

_TEXT = """\
# A world: check it with `zavis world check {name}.world.yaml`, look at it with `zavis world show {name}.world.yaml`.
format: zavis-world/1
name: {name}

# The occupancy map, as ROS map_server has it: white cells are free, black ones walls or furniture. Paint it with any
# image editor. Cell [0, 0] of the map is at its lower left; metres, x to the right, y up.
map: {name}.yaml
wall_height: 2.5

# Boxes on the floor. Black cells that touch a box are furniture of its height, all others are wall. yaw_deg turns the
# length counter-clockwise from x; height is the surface that bears objects.
furniture:
  - {{id: sofa_1, category: sofa, x: 2.5, y: 0.48, yaw_deg: 0, size: [2.0, 0.92], height: 0.45}}
  - {{id: desk_1, category: desk, x: 0.38, y: 3.0, yaw_deg: 90, size: [1.4, 0.7], height: 0.75}}

# Things to look for: boxes of size [x, y, z] that stand at height z, on a piece of furniture or on the floor.
objects:
  - {{id: wallet_1, category: wallet, x: 0.4, y: 2.7, z: 0.75, size: [0.11, 0.09, 0.025], on: desk_1, colour: red}}

# Where a robot may begin: x, y, yaw_deg.
starts:
  - [3.5, 2.5, 180]
"""


def write_starter(name: str, folder: Path) -> Path:
    """Write ``<name>.world.yaml`` with its map: one room with two pieces of furniture, explained by comments.

    Returns:
        The world file.

    Raises:
        InputError: The name is not one; a file of the world exists already or cannot be written.
    """
    name = name.removesuffix(".world.yaml")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
        raise InputError(f"world: '{name}' is not a name (a letter, then letters, digits, '-' or '_')")
    files = [folder / f"{name}{suffix}" for suffix in (".world.yaml", ".yaml", ".pgm")]
    for file in files:
        if file.exists():
            raise InputError(f"{file}: exists already (choose another name, or remove it)")
    sofa = Furniture("sofa_1", "sofa", 2.5, 0.48, 0.0, 2.0, 0.92, 0.45)
    desk = Furniture("desk_1", "desk", 0.38, 3.0, 1.5707963267948966, 1.4, 0.7, 0.75)
    save_map(files[1], FloorPlan(name, "", 5.0, 4.0, (), (sofa, desk), (), ()).grid())
    try:
        files[0].write_text(_TEXT.format(name=name), encoding="utf-8")
    except OSError as error:
        raise InputError(f"{files[0]}: cannot be written: {error.strerror}") from error
    return files[0]
