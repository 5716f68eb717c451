"""One picture of a mission: the map, what was found on it and how the robot went."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from zavis_bt.recording import marks
from zavis_bt.recording.canvas import Canvas, known_bounds
from zavis_bt.recording.frame import framed
from zavis_bt.recording.labels import draw, place
from zavis_bt.types import FloatArray, GridMap, Landmark, Pose2D

_MARGIN = 0.35  # around what is known [m]
_MIN_SCALE, _MAX_SCALE = 8.0, 130.0  # pixels a metre


def draw_map(
    grid: GridMap,
    *,
    trajectory: FloatArray | None = None,
    start: Pose2D | None = None,
    landmarks: Sequence[Landmark] = (),
    visited: Sequence[Pose2D] = (),
    frontiers: FloatArray | None = None,
    candidates: Sequence[Sequence[float]] = (),
    found: Sequence[float] | None = None,
    target: str = "",
    title: str = "",
    size: tuple[int, int] = (1400, 1000),
) -> NDArray[np.uint8]:
    """Draw the known part of a map and what happened on it.

    Args:
        grid: The occupancy map.
        trajectory: (n, 2) positions driven [m], drawn from blue (early) to orange (late).
        start: Where the robot began.
        landmarks: Circles with name and entropy [nat]; teal if certain of its name, orange if not.
        visited: Viewpoints in the order of their visits, numbered, with their headings.
        frontiers: (n, 2) frontier goals visited [m].
        candidates: Positions x, y of candidates [m].
        found: Position of the confirmed candidate [m].
        target: Its name.
        title: Heading; none if empty.
        size: Largest width and height of the map itself [px].

    Returns:
        (h, w, 3) rgb.
    """
    path = np.empty((0, 2)) if trajectory is None else np.asarray(trajectory, dtype=np.float64).reshape(-1, 2)
    goals = np.empty((0, 2)) if frontiers is None else np.asarray(frontiers, dtype=np.float64).reshape(-1, 2)
    spots = [*candidates, found] if found is not None else candidates
    places = [(pose.x, pose.y) for pose in visited] + [(spot[0], spot[1]) for spot in spots]
    places += [(landmark.position[0], landmark.position[1]) for landmark in landmarks]
    bounds = known_bounds(grid, np.vstack((path, goals, np.array(places, dtype=np.float64).reshape(-1, 2))), _MARGIN)
    fit = min(size[0] / (bounds[2] - bounds[0]), size[1] / (bounds[3] - bounds[1]))
    canvas = Canvas(bounds, float(np.clip(fit, _MIN_SCALE, _MAX_SCALE)))
    canvas.draw_grid(grid)
    items = [
        *marks.draw_landmarks(canvas, landmarks),
        *marks.draw_trajectory(canvas, path),
        *marks.draw_frontiers(canvas, goals),
        *marks.draw_start(canvas, start),
        *marks.draw_visited(canvas, visited),
        *marks.draw_candidates(canvas, candidates),
        *marks.draw_found(canvas, found, target),
    ]
    drawn = {item.kind for item in items}
    return framed(_labelled(canvas, items), canvas.scale, title, [kind for kind in marks.KINDS if kind in drawn])


def _labelled(canvas: Canvas, items: Sequence[marks.Mark]) -> NDArray[np.uint8]:
    from PIL import Image, ImageDraw

    image = Image.fromarray(canvas.finish())
    pen = ImageDraw.Draw(image, "RGBA")
    for item in items:
        if item.number:
            marks.draw_number(pen, item)
    labels = [item.label for item in reversed(items) if item.label is not None]
    for label, rectangle in zip(labels, place(labels, _rectangles(items), (canvas.width, canvas.height)), strict=True):
        draw(pen, label, rectangle)
    return np.asarray(image, dtype=np.uint8)


def _rectangles(items: Sequence[marks.Mark]) -> FloatArray:
    solid = [(u - r, v - r, u + r, v + r) for item in items if item.solid for (u, v), r in [(item.centre, item.radius)]]
    return np.array(solid, dtype=np.float64).reshape(-1, 4)
