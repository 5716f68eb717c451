"""The occupancy map in the scene: an image on the floor, and low walls."""

from __future__ import annotations

from io import BytesIO

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import OCCUPIED, UNKNOWN, FloatArray, GridMap
from zavis_bt.viz.solids import Colour, Solid, merged, quads

WALL_HEIGHT = 0.25  # high enough to be seen, low enough to look over [m]
_FREE: Colour = (252, 253, 255)
_WALL: Colour = (104, 114, 132)


def floor_image(grid: GridMap) -> bytes:
    """Return a PNG of the free and occupied cells, see-through where unknown, north up."""
    from PIL import Image

    colours = np.full((256, 3), _FREE, dtype=np.uint8)
    colours[OCCUPIED] = _WALL
    image = Image.fromarray(np.ascontiguousarray(grid.states[::-1]).view(np.uint8), "L").convert("P")
    image.putpalette(colours.tobytes())
    file = BytesIO()
    image.save(file, "PNG", transparency=UNKNOWN % 256)
    return file.getvalue()


def walls(grid: GridMap) -> Solid | None:
    """Return the occupied cells as low blocks, or None if there are none."""
    occupied = np.pad(grid.states == OCCUPIED, 1)
    if not occupied.any():
        return None
    rows = _sides(occupied)
    columns = _sides(occupied.T)[..., [1, 0, 2]]
    tint = np.array(_WALL) / 255
    parts = [(_tops(occupied), 1.0), (rows, 0.62), (columns, 0.78)]
    solids = [quads(corners, np.broadcast_to(shade * tint, (len(corners), 3))) for corners, shade in parts]
    solid = merged(solids)
    scale = np.array([grid.resolution, grid.resolution, WALL_HEIGHT])
    offset = np.array([grid.origin[0] - grid.resolution, grid.origin[1] - grid.resolution, 0.0])  # of the padding
    return Solid((solid.vertices * scale + offset).astype(np.float32), solid.colours, solid.faces)


def _runs(mask: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Return row, first column and end column of the runs of True in each row; the border columns are False."""
    change = np.diff(mask.astype(np.int8), axis=1)
    rows, first = np.nonzero(change == 1)
    _, end = np.nonzero(change == -1)
    return rows, first + 1, end + 1


def _tops(occupied: NDArray[np.bool_]) -> FloatArray:
    """Return (n, 4, 3) lids over runs of occupied cells, in cells, heights 0 to 1."""
    rows, first, end = _runs(occupied)
    return _corners((first, rows), (end, rows), (end, rows + 1), (first, rows + 1), heights=(1, 1, 1, 1))


def _sides(occupied: NDArray[np.bool_]) -> FloatArray:
    """Return (n, 4, 3) walls along the rows, where an occupied cell has a neighbour below or above that is not."""
    edges = occupied[1:] != occupied[:-1]
    rows, first, end = _runs(edges)
    lines = rows + 1
    return _corners((first, lines), (end, lines), (end, lines), (first, lines), heights=(0, 0, 1, 1))


def _corners(*spots: tuple[NDArray[np.intp], NDArray[np.intp]], heights: tuple[int, int, int, int]) -> FloatArray:
    """Return (n, 4, 3) corners of n quadrilaterals from four pairs of (n,) columns and rows."""
    points = [np.column_stack((x, y, np.full_like(x, z))) for (x, y), z in zip(spots, heights, strict=True)]
    return np.stack(points, axis=1).astype(np.float64)
