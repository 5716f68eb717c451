"""What is drawn on the map, mark by mark."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from zavis_bt.recording.canvas import Canvas, Colour, arrow_head, blend, diamond, star
from zavis_bt.recording.labels import Label, font
from zavis_bt.types import FloatArray, Landmark, Pose2D

if TYPE_CHECKING:
    from PIL import ImageDraw

CERTAIN, UNCERTAIN = (14, 138, 122), (236, 128, 24)
VIEWPOINT, CANDIDATE, FRONTIER = (43, 58, 103), (146, 72, 196), (196, 148, 30)
START, FOUND, FOUND_EDGE = (34, 160, 84), (255, 199, 26), (168, 40, 20)
WHITE: Colour = (255, 255, 255)
_SAME_PLACE = 18.0  # discs closer than this would hide each other [px]
KINDS = ("start", "trajectory", "landmark", "viewpoint", "frontier", "candidate", "found")


@dataclass(frozen=True, slots=True)
class Mark:
    """Something that was drawn, for its label, its entry in the legend and the room it needs."""

    kind: str
    centre: tuple[float, float] = (0.0, 0.0)
    """[px]"""
    radius: float = 0.0
    """[px]"""
    label: Label | None = None
    number: str = ""
    solid: bool = True
    """Whether labels should keep off it."""


def landmark_colour(landmark: Landmark) -> Colour:
    """Return teal for a certain name to orange for one that could be anything (entropy at its maximum)."""
    most = math.log(max(len(landmark.probabilities), 2))
    return blend(CERTAIN, UNCERTAIN, landmark.entropy / most)


def time_colours(count: int) -> NDArray[np.uint8]:
    """Return (count, 3) colours from early (blue) over magenta to late (orange)."""
    stops = np.array([(40, 74, 214), (150, 46, 190), (222, 62, 112), (245, 140, 48)], dtype=np.float64)
    where = np.linspace(0, len(stops) - 1, max(count, 1))
    channels = [np.interp(where, np.arange(len(stops)), stops[:, channel]) for channel in range(3)]
    return np.column_stack(channels).astype(np.uint8)[:count]


def draw_landmarks(canvas: Canvas, landmarks: Sequence[Landmark]) -> list[Mark]:
    """Draw circles of the landmarks' seen extent."""
    drawn = []
    for landmark in landmarks:
        centre = canvas.to_pixels(np.array([landmark.position[:2]]))[0]
        radius, colour = max(landmark.radius * canvas.scale, 6.0), landmark_colour(landmark)
        canvas.disc(centre, radius, colour, opacity=0.22)
        canvas.ring(centre, radius, colour, 2.0)
        canvas.disc(centre, 3.0, colour)
        anchor, ink = (centre[0], centre[1]), blend(colour, (0, 0, 0), 0.35)
        label = Label(landmark.label, anchor, min(radius, 7.0), f"{landmark.entropy:.2f}", colour=ink)
        drawn.append(Mark("landmark", anchor, 4.0, label))
    return drawn


def draw_trajectory(canvas: Canvas, points: FloatArray) -> list[Mark]:
    """Draw what was driven, coloured by time."""
    if len(points) < 2:
        return []
    canvas.line(points, WHITE, 5.5)
    canvas.gradient_line(points, time_colours(len(points) - 1), 3.0)
    return [Mark("trajectory", solid=False)]


def draw_frontiers(canvas: Canvas, goals: FloatArray) -> list[Mark]:
    """Draw visited frontier goals as small rings."""
    drawn = []
    for centre in canvas.to_pixels(goals):
        canvas.disc(centre, 6.0, WHITE)
        canvas.ring(centre, 5.0, FRONTIER, 2.5)
        drawn.append(Mark("frontier", (centre[0], centre[1]), 7.0))
    return drawn


def draw_start(canvas: Canvas, start: Pose2D | None) -> list[Mark]:
    """Draw an arrow where the robot began."""
    if start is None:
        return []
    centre = canvas.to_pixels(np.array([[start.x, start.y]]))[0]
    ahead = np.array([math.cos(start.yaw), -math.sin(start.yaw)])
    canvas.disc(centre, 12.0, WHITE)
    canvas.ring(centre, 11.0, START, 2.5)
    canvas.polygon(arrow_head(centre + 9 * ahead, start.yaw, 17.0), START, START, 1.0)
    label = Label("start", (centre[0], centre[1]), 13.0, colour=blend(START, (0, 0, 0), 0.35))
    return [Mark("start", (centre[0], centre[1]), 13.0, label)]


def draw_visited(canvas: Canvas, poses: Sequence[Pose2D]) -> list[Mark]:
    """Draw numbered discs with an arrow to where the robot looked."""
    places: list[tuple[FloatArray, list[int]]] = []
    for number, pose in enumerate(poses, start=1):
        centre = canvas.to_pixels(np.array([[pose.x, pose.y]]))[0]
        ahead = np.array([math.cos(pose.yaw), -math.sin(pose.yaw)])
        canvas.polygon(arrow_head(centre + 25 * ahead, pose.yaw, 20.0), VIEWPOINT, WHITE, 1.5)
        here = next((numbers for place, numbers in places if np.hypot(*(place - centre)) < _SAME_PLACE), None)
        if here is None:
            places.append((centre, [number]))
        else:
            here.append(number)
    return [_numbered(canvas, (centre[0], centre[1]), numbers) for centre, numbers in places]


def _numbered(canvas: Canvas, centre: tuple[float, float], numbers: Sequence[int]) -> Mark:
    """Draw the disc of a place; where the robot was there again, a label has the later numbers."""
    canvas.disc(np.array(centre), 12.5, WHITE)
    canvas.disc(np.array(centre), 11.0, VIEWPOINT)
    later = ", ".join(str(number) for number in numbers[1:])
    label = Label(later, centre, 14.0, colour=WHITE, plate=VIEWPOINT, size=13) if later else None
    return Mark("viewpoint", centre, 14.0, label, str(numbers[0]))


def draw_candidates(canvas: Canvas, positions: Sequence[Sequence[float]]) -> list[Mark]:
    """Draw diamonds."""
    drawn = []
    for position in positions:
        centre = canvas.to_pixels(np.array([position[:2]], dtype=np.float64))[0]
        canvas.polygon(diamond(centre, 7.0), CANDIDATE, WHITE, 1.5)
        drawn.append(Mark("candidate", (centre[0], centre[1]), 7.0))
    return drawn


def draw_found(canvas: Canvas, position: Sequence[float] | None, target: str) -> list[Mark]:
    """Draw a star with the target's name."""
    if position is None:
        return []
    centre = canvas.to_pixels(np.array([position[:2]], dtype=np.float64))[0]
    canvas.polygon(star(centre, 20.0), FOUND, WHITE, 5.0)
    canvas.polygon(star(centre, 18.0), FOUND, FOUND_EDGE, 2.0)
    label = Label(target or "found", (centre[0], centre[1]), 19.0, colour=WHITE, plate=FOUND_EDGE, size=18)
    return [Mark("found", (centre[0], centre[1]), 20.0, label)]


def draw_number(pen: ImageDraw.ImageDraw, mark: Mark) -> None:
    """Write a viewpoint's number into its disc."""
    pen.text(mark.centre, mark.number, fill=WHITE, font=font(14 if len(mark.number) < 3 else 11), anchor="mm")
