"""A world drawn as an image: the map, labelled furniture and objects, starts."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.world import Furniture, World
from zavis_bt.errors import InputError
from zavis_bt.types import FREE, UNKNOWN, Pose2D

Image = NDArray[np.uint8]
Colour = tuple[int, int, int]

_FONT = cv2.FONT_HERSHEY_SIMPLEX
_WALL, _UNKNOWN, _FREE = (70, 70, 70), (205, 205, 205), (255, 255, 255)  # BGR
_FURNITURE, _EDGE, _NAME = (222, 205, 176), (150, 110, 60), (90, 55, 15)
_OBJECT, _START = (40, 40, 200), (60, 140, 40)


class Label(NamedTuple):
    """Text at a point of the image [px]."""

    text: str
    x: int
    y: int
    scale: float
    colour: Colour


def draw(world: World, longest: int = 1600) -> Image:
    """Return a picture of the world, (h, w, 3) BGR, whose longer side has about that many pixels."""
    rows, cols = world.grid.shape
    zoom = max(longest // max(rows, cols), 1)
    image = _floor(world, zoom)
    for piece in world.furniture:
        corners = np.array([_pixel(world, zoom, *corner) for corner in _corners(piece)], dtype=np.int32)
        cv2.fillPoly(image, [corners], _FURNITURE)
        cv2.polylines(image, [corners], True, _EDGE, 2, cv2.LINE_AA)
    for start in world.starts:
        _arrow(image, world, zoom, start)
    for thing in world.objects:
        cv2.circle(image, _pixel(world, zoom, thing.x, thing.y), 5, _OBJECT, -1, cv2.LINE_AA)
    _write(image, _labels(world, zoom), [_pixel(world, zoom, thing.x, thing.y) for thing in world.objects])
    return image


def save_picture(world: World, path: Path) -> None:
    """Write the picture; the file's ending decides the format.

    Raises:
        InputError: The file cannot be written.
    """
    try:
        written, data = cv2.imencode(path.suffix, draw(world))
    except cv2.error:
        written = False
    if not written:
        raise InputError(f"{path}: not a kind of image that can be written (.png, .jpg)")
    try:
        path.write_bytes(data.tobytes())
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error


def _floor(world: World, zoom: int) -> Image:
    shade = np.full((*world.grid.shape, 3), _WALL, dtype=np.uint8)
    shade[world.grid.states == UNKNOWN] = _UNKNOWN
    shade[world.grid.states == FREE] = _FREE
    shade[world.furniture_cells] = _FURNITURE
    return np.ascontiguousarray(shade[::-1].repeat(zoom, axis=0).repeat(zoom, axis=1))


def _pixel(world: World, zoom: int, x: float, y: float) -> tuple[int, int]:
    (x0, y0), scale = world.grid.origin, zoom / world.grid.resolution
    return round((x - x0) * scale), round(world.grid.shape[0] * zoom - (y - y0) * scale)


def _corners(piece: Furniture) -> Iterable[tuple[float, float]]:
    middle = Pose2D(piece.x, piece.y, piece.yaw)
    for along, across in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        corner = middle @ Pose2D(along * piece.length / 2, across * piece.width / 2)
        yield corner.x, corner.y


def _arrow(image: Image, world: World, zoom: int, start: Pose2D) -> None:
    tip = start @ Pose2D(0.3, 0.0)
    tail_px, tip_px = _pixel(world, zoom, start.x, start.y), _pixel(world, zoom, tip.x, tip.y)
    cv2.circle(image, tail_px, 7, _START, 2, cv2.LINE_AA)
    cv2.arrowedLine(image, tail_px, tip_px, _START, 2, cv2.LINE_AA, tipLength=0.35)


def _labels(world: World, zoom: int) -> list[Label]:
    pieces = [Label(piece.id, *_pixel(world, zoom, piece.x, piece.y), 0.5, _NAME) for piece in world.furniture]
    things = [
        Label(f"{thing.colour or ''} {thing.category}".strip(), *_pixel(world, zoom, thing.x, thing.y), 0.38, _OBJECT)
        for thing in world.objects
    ]
    return things + pieces


def _write(image: Image, labels: Iterable[Label], dots: Iterable[tuple[int, int]]) -> None:
    """Write every label where it hides least of the dots and of the labels before it, and keeps off the walls."""
    dark = (image == _WALL).all(axis=2)
    taken = [(x - 5, y - 5, x + 5, y + 5) for x, y in dots]
    for label in labels:
        (width, height), _ = cv2.getTextSize(label.text, _FONT, label.scale, 1)
        places = list(_places(label, width, height, image.shape))
        hidden = [
            sum(_common((x0, y0, x1, y1), other) for other in taken) + int(dark[y0:y1, x0:x1].sum())
            for x0, y0, x1, y1 in places
        ]
        x0, y0, x1, y1 = places[int(np.argmin(hidden))]
        taken.append((x0, y0, x1, y1))
        cv2.putText(image, label.text, (x0, y1), _FONT, label.scale, label.colour, 1, cv2.LINE_AA)


def _places(label: Label, width: int, height: int, shape: tuple[int, ...]) -> Iterable[tuple[int, int, int, int]]:
    """Yield rectangles around the label's point, nearest first, inside the image."""
    for ring in range(4):
        for eighth in range(8 if ring else 1):
            angle = eighth * math.pi / 4
            x = label.x + round(math.cos(angle) * ring * (width / 2 + 8)) - width // 2
            y = label.y - round(math.sin(angle) * ring * (height + 4)) - height // 2
            x, y = min(max(x, 2), shape[1] - width - 2), min(max(y, 2), shape[0] - height - 2)
            yield x, y, x + width, y + height


def _common(one: tuple[int, int, int, int], other: tuple[int, int, int, int]) -> int:
    wide = min(one[2], other[2]) - max(one[0], other[0])
    high = min(one[3], other[3]) - max(one[1], other[1])
    return max(wide, 0) * max(high, 0)
