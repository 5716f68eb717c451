"""A world drawn with characters, for the terminal."""

from __future__ import annotations

import math
import string

import numpy as np

from sim.world import World
from zavis_bt.types import FREE, UNKNOWN

_ARROWS = "→↗↑↖←↙↓↘"
_MARKS = string.ascii_lowercase + string.ascii_uppercase


def sketch(world: World, columns: int) -> str:
    """Return the world in lines of at most ``columns`` characters, and a legend.

    A character is twice as high as it is wide. ``█`` wall, ``▒`` furniture with a letter in its middle, ``•`` object,
    arrows are starts.
    """
    rows, cols = world.grid.shape
    wide = max(math.ceil(cols / max(columns, 20)), 1)
    picture = [[_shade(world, row, col, wide) for col in range(0, cols, wide)] for row in range(0, rows, 2 * wide)]

    def put(x: float, y: float, mark: str) -> None:
        row, col = world.grid.to_cells(np.array([[x, y]]))[0]
        if 0 <= row < rows and 0 <= col < cols:
            picture[int(row) // (2 * wide)][int(col) // wide] = mark

    for thing in world.objects:
        put(thing.x, thing.y, "•")
    for piece, mark in zip(world.furniture, _MARKS, strict=False):
        put(piece.x, piece.y, mark)
    for start in world.starts:
        put(start.x, start.y, _ARROWS[round(start.yaw / (math.pi / 4)) % 8])
    lines = ["".join(line).rstrip() for line in reversed(picture)]
    return "\n".join([*lines, "", *_legend(world, columns)])


def _shade(world: World, row: int, col: int, wide: int) -> str:
    window = (slice(row, row + 2 * wide), slice(col, col + wide))
    states = world.grid.states[window]
    if (states == FREE).mean() > 0.5:
        return " "
    if world.furniture_cells[window].sum() >= world.walls[window].sum():
        return "▒"
    return "░" if (states == UNKNOWN).mean() > 0.5 else "█"


def _legend(world: World, columns: int) -> list[str]:
    entries = [f"{mark} {piece.id}" for piece, mark in zip(world.furniture, _MARKS, strict=False)]
    lines = [""]
    for entry in entries:
        if len(lines[-1]) + len(entry) + 2 > max(columns, 20) and lines[-1]:
            lines.append("")
        lines[-1] += ("  " if lines[-1] else "") + entry
    return lines
