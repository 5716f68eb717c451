"""Draws the built-in worlds: ``python -m sim.worlds.draw [FOLDER]``.

Furniture stands 2 cm off the walls, so that no cell of a wall touches it.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable
from pathlib import Path

from sim.world import Furniture, WorldObject
from sim.worlds.paint import FloorPlan, Wall, write_world
from zavis_bt.types import Pose2D

_SIZES = {
    "alarm clock": (0.14, 0.08, 0.12), "basket ball": (0.24, 0.24, 0.24), "book": (0.21, 0.15, 0.03),
    "boots": (0.28, 0.24, 0.20), "bowl": (0.20, 0.20, 0.09), "box": (0.40, 0.30, 0.28), "candle": (0.07, 0.07, 0.14),
    "cd": (0.12, 0.12, 0.01), "cell phone": (0.15, 0.08, 0.01), "cloth": (0.25, 0.20, 0.03),
    "credit card": (0.086, 0.054, 0.004), "key chain": (0.10, 0.06, 0.02), "laptop": (0.33, 0.24, 0.22),
    "mug": (0.12, 0.09, 0.10), "newspaper": (0.40, 0.30, 0.02), "pen": (0.14, 0.02, 0.01), "pencil": (0.17, 0.01, 0.01),
    "pillow": (0.45, 0.40, 0.16), "plate": (0.26, 0.26, 0.02), "remote control": (0.18, 0.05, 0.02),
    "soap bar": (0.09, 0.06, 0.03), "statue": (0.14, 0.12, 0.28), "teddy bear": (0.28, 0.26, 0.34),
    "tennis racket": (0.68, 0.27, 0.04), "tissue box": (0.23, 0.12, 0.10), "toilet paper": (0.11, 0.11, 0.10),
    "towel": (0.40, 0.25, 0.06), "vase": (0.14, 0.14, 0.30), "wallet": (0.11, 0.09, 0.025), "watch": (0.08, 0.06, 0.03),
    "watering can": (0.34, 0.16, 0.26), "wine bottle": (0.08, 0.08, 0.31),
}  # fmt: skip


def _piece(id: str, x: float, y: float, yaw_deg: float, length: float, width: float, height: float) -> Furniture:
    """Return a piece whose category is its id without the number."""
    category = id.rpartition("_")[0].replace("_", " ")
    return Furniture(id, category, x, y, math.radians(yaw_deg), length, width, height)


def _objects(
    furniture: Iterable[Furniture], entries: Iterable[tuple[str, str | None, float, float, str | None]]
) -> list[WorldObject]:
    """Return objects from (category, bearer, x, y, colour): x and y from the bearer's centre, or in the map."""
    bearers = {piece.id: piece for piece in furniture}
    counts: dict[str, int] = {}
    objects = []
    for category, on, x, y, colour in entries:
        counts[category] = counts.get(category, 0) + 1
        x0, y0, z = (bearers[on].x, bearers[on].y, bearers[on].height) if on else (0.0, 0.0, 0.0)
        id = f"{category.replace(' ', '_')}_{counts[category]}"
        objects.append(WorldObject(id, category, x0 + x, y0 + y, z, _SIZES[category], on, colour))
    return objects


def apartment() -> FloorPlan:
    """Return a home of 10 m × 8 m: living room, kitchen, bedroom and study around a hall."""
    walls = [
        Wall(4.6, 0.0, 4.7, 1.9), Wall(4.6, 3.1, 4.7, 5.3), Wall(4.6, 6.4, 4.7, 8.0),  # hall to living room, kitchen
        Wall(6.2, 0.0, 6.3, 2.5), Wall(6.2, 3.6, 6.3, 5.2), Wall(6.2, 6.3, 6.3, 8.0),  # hall to bedroom, study
        Wall(0.0, 4.6, 1.7, 4.7), Wall(2.9, 4.6, 4.6, 4.7),  # living room to kitchen
        Wall(6.3, 4.2, 10.0, 4.3),  # bedroom to study
    ]  # fmt: skip
    furniture = [
        # living room
        _piece("sofa_1", 0.48, 1.55, 90, 2.00, 0.92, 0.45),
        _piece("coffee_table_1", 1.85, 1.55, 90, 1.00, 0.60, 0.42),
        _piece("tv_stand_1", 4.37, 0.85, 90, 1.40, 0.42, 0.52),
        _piece("armchair_1", 0.78, 3.62, -45, 0.80, 0.80, 0.42),
        _piece("side_table_1", 0.27, 2.85, 0, 0.46, 0.46, 0.55),
        _piece("floor_lamp_1", 0.20, 0.22, 0, 0.32, 0.32, 1.60),
        _piece("shelf_1", 3.75, 4.40, 0, 1.30, 0.36, 1.10),
        # kitchen
        _piece("countertop_1", 1.87, 7.67, 0, 3.66, 0.62, 0.92),
        _piece("fridge_1", 4.22, 7.62, 0, 0.70, 0.70, 1.80),
        _piece("dining_table_1", 0.98, 5.85, 90, 1.30, 0.82, 0.75),
        _piece("chair_1", 0.26, 5.85, 0, 0.44, 0.44, 0.90),
        _piece("chair_2", 1.64, 5.95, 180, 0.44, 0.44, 0.90),
        _piece("chair_3", 0.98, 4.95, 90, 0.44, 0.44, 0.90),
        _piece("garbage_can_1", 4.40, 6.95, 0, 0.32, 0.32, 0.45),
        # bedroom
        _piece("bed_1", 8.96, 1.62, 180, 2.04, 1.62, 0.58),
        _piece("side_table_2", 9.74, 0.48, 0, 0.46, 0.46, 0.55),
        _piece("side_table_3", 9.74, 2.76, 0, 0.46, 0.46, 0.55),
        _piece("dresser_1", 8.80, 3.94, 0, 1.30, 0.48, 0.95),
        _piece("cabinet_1", 6.63, 0.75, -90, 1.20, 0.62, 1.95),
        # study
        _piece("desk_1", 8.60, 7.62, 0, 1.60, 0.72, 0.75),
        _piece("chair_4", 8.60, 7.02, 90, 0.48, 0.48, 0.90),
        _piece("shelf_2", 9.80, 5.60, 90, 1.70, 0.36, 1.30),
        _piece("armchair_2", 7.00, 7.28, -45, 0.80, 0.80, 0.42),
        _piece("floor_lamp_2", 6.50, 7.80, 0, 0.32, 0.32, 1.60),
        _piece("cabinet_2", 7.70, 4.54, 0, 1.10, 0.44, 0.85),
        _piece("garbage_can_2", 9.72, 7.74, 0, 0.32, 0.32, 0.40),
        # hall
        _piece("cabinet_3", 6.02, 1.20, 90, 0.90, 0.32, 0.85),
        _piece("side_table_4", 5.45, 7.78, 0, 0.90, 0.38, 0.78),
    ]
    objects = _objects(
        furniture,
        [
            ("remote control", "coffee_table_1", -0.10, 0.25, "black"),
            ("newspaper", "coffee_table_1", 0.02, -0.20, None), ("candle", "coffee_table_1", 0.12, 0.10, "white"),
            ("pillow", "sofa_1", -0.05, 0.65, "blue"),
            ("pillow", "sofa_1", -0.05, -0.65, "blue"), ("book", "side_table_1", 0.05, -0.04, "green"),
            ("statue", "tv_stand_1", 0.00, 0.50, None), ("cd", "tv_stand_1", -0.05, -0.45, None),
            ("vase", "shelf_1", 0.40, 0.00, "white"), ("book", "shelf_1", -0.30, 0.02, "red"),
            ("book", "shelf_1", 0.00, 0.02, "blue"), ("cloth", "armchair_1", 0.00, 0.00, "grey"),
            ("basket ball", None, 3.05, 0.35, "orange"),
            ("plate", "dining_table_1", 0.15, 0.35, "white"), ("mug", "dining_table_1", 0.20, -0.10, "white"),
            ("bowl", "dining_table_1", -0.05, -0.40, "yellow"), ("mug", "countertop_1", 0.60, -0.05, "red"),
            ("bowl", "countertop_1", -1.20, 0.00, "white"), ("wine bottle", "countertop_1", 1.45, 0.10, "green"),
            ("watering can", "countertop_1", -0.40, 0.08, "green"),
            ("wallet", "side_table_3", -0.08, 0.06, "red"), ("alarm clock", "side_table_3", 0.10, -0.10, "black"),
            ("cell phone", "side_table_2", -0.06, 0.05, "black"), ("tissue box", "side_table_2", 0.08, -0.10, None),
            ("pillow", "bed_1", 0.70, 0.40, "white"), ("pillow", "bed_1", 0.70, -0.40, "white"),
            ("teddy bear", "bed_1", 0.25, -0.05, "brown"), ("watch", "dresser_1", 0.35, -0.05, None),
            ("candle", "dresser_1", -0.45, 0.05, "red"), ("box", None, 6.62, 3.92, "brown"),
            ("laptop", "desk_1", 0.00, 0.05, "grey"), ("mug", "desk_1", 0.45, -0.10, "blue"),
            ("pen", "desk_1", -0.35, -0.15, "blue"), ("pencil", "desk_1", -0.45, -0.05, None),
            ("credit card", "desk_1", 0.60, 0.10, None), ("book", "shelf_2", 0.00, 0.45, "yellow"),
            ("box", "shelf_2", 0.00, -0.50, "white"), ("tennis racket", "cabinet_2", 0.05, 0.00, None),
            ("newspaper", "armchair_2", 0.00, 0.00, None),
            ("key chain", "cabinet_3", -0.02, 0.20, None), ("credit card", "cabinet_3", 0.02, -0.18, None),
            ("vase", "side_table_4", 0.20, 0.02, "blue"), ("boots", None, 5.98, 0.30, "brown"),
        ],
    )  # fmt: skip
    starts = [
        Pose2D(5.2, 0.7, math.radians(90)), Pose2D(3.3, 2.6, math.radians(180)), Pose2D(2.9, 6.4, math.radians(-90)),
        Pose2D(7.2, 2.2, 0.0), Pose2D(8.3, 5.6, math.radians(90)), Pose2D(5.4, 4.6, math.radians(-90)),
    ]  # fmt: skip
    source = "living room, kitchen, bedroom, study and hall, drawn by sim/worlds/draw.py"
    return FloorPlan("apartment", source, 10.0, 8.0, walls, furniture, objects, starts)


def flat() -> FloorPlan:
    """Return a home of one room with a bath and an entry, 7 m × 4.4 m."""
    walls = [Wall(4.8, 0.0, 4.9, 2.7), Wall(4.8, 3.9, 4.9, 4.4), Wall(4.9, 2.2, 5.2, 2.3), Wall(6.3, 2.2, 7.0, 2.3)]
    furniture = [
        _piece("bed_1", 1.04, 0.74, 0, 2.04, 1.42, 0.55),
        _piece("side_table_1", 0.25, 1.75, 0, 0.44, 0.44, 0.52),
        _piece("desk_1", 3.55, 0.36, 0, 1.30, 0.66, 0.75),
        _piece("chair_1", 3.55, 0.92, -90, 0.46, 0.46, 0.90),
        _piece("countertop_1", 1.02, 4.07, 0, 1.96, 0.62, 0.92),
        _piece("fridge_1", 2.36, 4.07, 0, 0.62, 0.62, 1.60),
        _piece("dining_table_1", 3.85, 4.00, 0, 0.90, 0.72, 0.75),
        _piece("armchair_1", 0.46, 2.72, 0, 0.78, 0.78, 0.42),
        _piece("shelf_1", 4.60, 1.55, 90, 0.90, 0.34, 1.30),
        _piece("garbage_can_1", 2.92, 4.20, 0, 0.30, 0.30, 0.40),
        _piece("toilet_1", 6.62, 0.36, 180, 0.66, 0.40, 0.42),
        _piece("sink_1", 5.17, 0.80, 90, 0.60, 0.48, 0.85),
        _piece("cabinet_1", 6.82, 3.40, 90, 1.00, 0.32, 0.90),
    ]
    objects = _objects(
        furniture,
        [
            ("pillow", "bed_1", -0.70, 0.00, "white"), ("book", "bed_1", 0.40, 0.20, "red"),
            ("alarm clock", "side_table_1", -0.05, 0.05, "black"), ("cell phone", "side_table_1", 0.08, -0.08, "black"),
            ("laptop", "desk_1", 0.00, 0.05, "grey"), ("pen", "desk_1", 0.40, -0.05, None),
            ("mug", "desk_1", -0.45, 0.00, "white"), ("bowl", "countertop_1", -0.50, 0.00, "blue"),
            ("plate", "countertop_1", 0.30, 0.05, "white"), ("mug", "dining_table_1", -0.20, -0.10, "red"),
            ("newspaper", "dining_table_1", 0.10, 0.05, None), ("wallet", "shelf_1", 0.00, 0.15, "red"),
            ("vase", "shelf_1", 0.00, -0.25, "white"), ("remote control", "armchair_1", 0.10, 0.00, "black"),
            ("soap bar", "sink_1", 0.05, 0.18, None), ("toilet paper", "toilet_1", 0.20, 0.00, "white"),
            ("key chain", "cabinet_1", 0.00, -0.20, None), ("credit card", "cabinet_1", 0.02, 0.25, None),
        ],
    )  # fmt: skip
    starts = [Pose2D(5.8, 3.4, math.radians(180)), Pose2D(2.4, 2.3, 0.0), Pose2D(5.9, 1.4, math.radians(90))]
    source = "one room, bath and entry, drawn by sim/worlds/draw.py"
    return FloorPlan("flat", source, 7.0, 4.4, walls, furniture, objects, starts)


def main() -> None:
    """Write the built-in worlds."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    for plan in (apartment(), flat()):
        write_world(plan, folder)


if __name__ == "__main__":
    main()
