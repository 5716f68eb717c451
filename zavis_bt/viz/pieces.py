"""The things in the scene, one by one."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from zavis_bt.recording.marks import CANDIDATE, FOUND, FOUND_EDGE, VIEWPOINT, landmark_colour, time_colours
from zavis_bt.types import Candidate, FloatArray, Landmark, LaserScan, Path, Viewpoint
from zavis_bt.viz import shapes
from zavis_bt.viz.solids import Colour, Solid, cylinder, disc, flat, merged, ribbon, transformed
from zavis_bt.viz.text import badge, plate

Piece = Callable[[], dict[str, shapes.Json | None]]
"""Draws a thing: its parts by name."""

_PATH: Colour = (38, 98, 217)
_HIT: Colour = (226, 52, 52)
_BEAM: Colour = (90, 160, 255)
_DONE: Colour = (140, 148, 162)
_TEXT, _BADGE = 0.019, 0.021  # heights of texts as a share of the distance to the viewer
_CLOSE = 0.9  # landmarks nearer to each other than this would hide each other's names [m]
_MOST_POINTS = 600  # of the drawn trajectory


def path(followed: Path) -> shapes.Json | None:
    """Return the path as a band on the floor."""
    points = followed.points
    if len(points) < 2:
        return None
    colours = np.broadcast_to(np.array(_PATH) / 255, (len(points), 3))
    return shapes.mesh(ribbon(points, colours, 0.06, 0.03), opacity=0.55)


def trajectory(points: FloatArray) -> shapes.Json | None:
    """Return what was driven as a band, from blue (early) to orange (late)."""
    if len(points) < 2:
        return None
    shown = np.unique(np.linspace(0, len(points) - 1, min(len(points), _MOST_POINTS)).astype(int))
    return shapes.mesh(ribbon(points[shown], time_colours(len(shown)) / 255, 0.05, 0.02))


def scan(latest: LaserScan | None) -> dict[str, shapes.Json | None]:
    """Return the scan's hits and the area its beams cross, in the LiDAR's frame."""
    if latest is None:
        return {"hits": None, "beams": None}
    reach = np.where(np.isfinite(latest.ranges), latest.ranges, latest.range_max)
    rays = np.column_stack((np.cos(latest.angles), np.sin(latest.angles), np.zeros(len(reach))))
    ends = reach[:, None] * rays
    hits = ends[np.isfinite(latest.ranges)]
    first = np.arange(1, len(ends), dtype=np.uint32)
    faces = np.column_stack((np.zeros_like(first), first, first + 1)).astype(np.uint32)
    fan = np.vstack((np.zeros((1, 3)), ends)).astype(np.float32)
    tint = np.full((len(fan), 3), np.array(_BEAM) / 255, dtype=np.float32)
    return {
        "hits": shapes.dots(hits, _HIT, 0.09) if len(hits) else None,
        "beams": shapes.mesh(Solid(fan, tint, faces), opacity=0.13),
    }


def landmarks(marks: Sequence[Landmark]) -> Iterator[tuple[str, object, Piece]]:
    """Yield discs of the landmarks' extents with poles that bear their names, the higher the more stand close by."""
    for number, mark in enumerate(marks):
        close = sum(math.dist(mark.position[:2], other.position[:2]) < _CLOSE for other in marks[:number])
        yield str(mark.id), (mark, close), _landmark(mark, 0.3 * min(close, 5))


def viewpoints(visited: Sequence[Viewpoint], ahead: Sequence[Viewpoint]) -> Iterator[tuple[str, object, Piece]]:
    """Yield numbered arrows, grey where the robot has been."""
    for number, viewpoint in enumerate((*visited, *ahead), start=1):
        colour = _DONE if number <= len(visited) else VIEWPOINT
        yield str(number), (viewpoint, colour), _arrow(viewpoint, number, colour)


def candidates(seen: Sequence[Candidate], found: Candidate | None) -> Iterator[tuple[str, object, Piece]]:
    """Yield markers where candidates were seen, and a pillar with the target's name where it was found."""
    for number, candidate in enumerate(seen):
        yield str(number), candidate.position, _marker(candidate)
    if found is not None:
        yield "found", found.position, _pillar(found)


def _arrow(viewpoint: Viewpoint, number: int, colour: Colour) -> Piece:
    def draw() -> dict[str, shapes.Json | None]:
        pose = viewpoint.pose
        head = flat(np.array([[0.46, 0.0], [0.12, 0.16], [0.12, -0.16]]), 0.035, colour)
        arrow = merged([disc((0, 0, 0.034), 0.13, colour), head])
        mark = badge(str(number), colour)
        return {
            "arrow": shapes.mesh(transformed(arrow, pose.x, pose.y, pose.yaw)),
            "number": shapes.sprite(mark.png, (pose.x, pose.y, 0.12), mark.aspect, _BADGE),
        }

    return draw


def _marker(candidate: Candidate) -> Piece:
    def draw() -> dict[str, shapes.Json | None]:
        x, y, z = candidate.position
        stalk = cylinder((x, y, 0.0), 0.008, max(z, 0.05), CANDIDATE, sides=6)
        low = cylinder((x, y, z - 0.09), 0.0, 0.09, CANDIDATE, top=0.07, sides=4)
        high = cylinder((x, y, z), 0.07, 0.09, CANDIDATE, top=0.0, sides=4)
        return {"marker": shapes.mesh(merged([stalk, low, high]))}

    return draw


def _pillar(found: Candidate) -> Piece:
    def draw() -> dict[str, shapes.Json | None]:
        x, y, z = found.position
        name = plate(found.target or "found", "", (255, 255, 255), FOUND_EDGE)
        ring = disc((x, y, 0.264), 0.34, FOUND, inner=0.22)
        core = cylinder((x, y, 0.0), 0.05, max(z, 0.5) + 0.75, FOUND, sides=16)
        return {
            "pillar": shapes.mesh(merged([ring, core])),
            "glow": shapes.mesh(cylinder((x, y, 0.0), 0.22, max(z, 0.5) + 0.75, FOUND), opacity=0.3),
            "name": shapes.sprite(name.png, (x, y, max(z, 0.5) + 0.95), name.aspect, 1.2 * _TEXT),
        }

    return draw


def _darker(colour: Colour) -> Colour:
    return (round(0.6 * colour[0]), round(0.6 * colour[1]), round(0.6 * colour[2]))


def _landmark(mark: Landmark, lift: float) -> Piece:
    def draw() -> dict[str, shapes.Json | None]:
        (x, y, z), colour = mark.position, landmark_colour(mark)
        top = max(z, 0.3) + 0.3 + lift
        radius = max(mark.radius, 0.08)
        rim = disc((x, y, 0.262), radius, colour, inner=max(radius - 0.05, 0.0))
        pole = cylinder((x, y, 0.0), 0.02, top, colour, sides=8)
        name = plate(mark.label, f"{mark.entropy:.2f}", _darker(colour))
        return {
            "area": shapes.mesh(disc((x, y, 0.26), radius, colour), opacity=0.3),
            "solid": shapes.mesh(merged([rim, pole])),
            "name": shapes.sprite(name.png, (x, y, top + 0.1), name.aspect, _TEXT),
        }

    return draw
