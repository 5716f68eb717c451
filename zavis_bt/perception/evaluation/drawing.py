"""Images with boxes, and sheets of them."""

from __future__ import annotations

import colorsys
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from zavis_bt.types import UNKNOWN_CLASS, Box

Colour = tuple[int, int, int]
TRUTH: Colour = (255, 255, 255)
UNKNOWN: Colour = (255, 60, 220)
_DARK: Colour = (16, 20, 28)
_GAP = 6  # between the pictures of a sheet [px]
_DASH = (7, 5)  # stroke and space [px]


@dataclass(frozen=True, slots=True)
class Mark:
    """One box to draw."""

    box: Box
    text: str
    colour: Colour
    dashed: bool = False
    width: int = 2


def class_colour(label: str) -> Colour:
    """Return a bright colour that is always the same for a class; `UNKNOWN` for ``unknown``."""
    if label == UNKNOWN_CLASS:
        return UNKNOWN
    hue = zlib.crc32(label.encode()) % 293 / 360  # leaves out the hues near that of unknown
    red, green, blue = colorsys.hsv_to_rgb(hue, 0.85, 1.0)
    return round(red * 255), round(green * 255), round(blue * 255)


def draw(rgb: NDArray[np.uint8] | Image.Image, marks: Sequence[Mark], scale: float = 1.0) -> Image.Image:
    """Return an image with boxes on it; their coordinates are multiplied by ``scale``."""
    image = rgb.copy() if isinstance(rgb, Image.Image) else Image.fromarray(rgb)
    pen = ImageDraw.Draw(image)
    for mark in marks:
        _outline(pen, mark, scale)
    for mark in marks:  # no box hides a text
        if mark.text:
            _write(pen, mark, scale, image.size)
    return image


def sheet(pictures: Sequence[Image.Image], captions: Sequence[str], columns: int) -> Image.Image:
    """Return pictures in rows with a line of text below each."""
    columns = max(min(columns, len(pictures)), 1)
    width = max((picture.width for picture in pictures), default=1)
    height = max((picture.height for picture in pictures), default=1)
    line = 16 if any(captions) else 0
    rows = -(-len(pictures) // columns)
    size = (columns * (width + _GAP) - _GAP, max(rows * (height + line + _GAP) - _GAP, 1))
    whole = Image.new("RGB", size, (255, 255, 255))
    pen = ImageDraw.Draw(whole)
    for k, (picture, caption) in enumerate(zip(pictures, captions, strict=True)):
        x, y = k % columns * (width + _GAP), k // columns * (height + line + _GAP)
        whole.paste(picture, (x + (width - picture.width) // 2, y + (height - picture.height) // 2))
        pen.text(
            (x + width / 2, y + height + 1), _fitting(caption, width, pen), fill=_DARK, font=_font(12), anchor="ma"
        )
    return whole


def window(box: Box, size: tuple[int, int], margin: float = 0.6) -> tuple[int, int, int, int]:
    """Return a square of pixels around a box, with a margin as a share of its longer side, inside the image."""
    side = min(max(box.x1 - box.x0, box.y1 - box.y0, 16.0) * (1 + 2 * margin), min(size))
    corner = []
    for low, high, most in ((box.x0, box.x1, size[0]), (box.y0, box.y1, size[1])):
        corner.append(int(min(max((low + high - side) / 2, 0.0), most - side)))
    return corner[0], corner[1], corner[0] + max(int(side), 1), corner[1] + max(int(side), 1)


def _fitting(text: str, width: int, pen: ImageDraw.ImageDraw) -> str:
    """Return the text, shortened in the middle if it is wider than this."""
    short = text
    while pen.textlength(short, font=_font(12)) > width and len(short) > 3:
        half = (len(short) - 2) // 2
        short = f"{short[:half]}…{short[-half:]}"
    return short


def _outline(pen: ImageDraw.ImageDraw, mark: Mark, scale: float) -> None:
    x0, y0, x1, y1 = (value * scale for value in mark.box)
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
    for begin, end in pairwise(corners):
        for part in _strokes(begin, end) if mark.dashed else [(begin, end)]:
            pen.line([*part], fill=_DARK, width=mark.width + 2)
            pen.line([*part], fill=mark.colour, width=mark.width)


def _strokes(
    begin: tuple[float, float], end: tuple[float, float]
) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    length = max(abs(end[0] - begin[0]), abs(end[1] - begin[1]), 1e-9)
    direction = ((end[0] - begin[0]) / length, (end[1] - begin[1]) / length)
    starts = np.arange(0.0, length, sum(_DASH))
    ends = np.minimum(starts + _DASH[0], length)
    return [
        (
            (begin[0] + direction[0] * a, begin[1] + direction[1] * a),
            (begin[0] + direction[0] * b, begin[1] + direction[1] * b),
        )
        for a, b in zip(starts.tolist(), ends.tolist(), strict=True)
    ]


def _write(pen: ImageDraw.ImageDraw, mark: Mark, scale: float, size: tuple[int, int]) -> None:
    font = _font(11)
    width, height = pen.textlength(mark.text, font=font) + 4, 13
    x = min(max(mark.box.x0 * scale, 0.0), max(size[0] - width, 0.0))
    y = mark.box.y0 * scale - height
    y = y if y >= 0 else min(mark.box.y0 * scale + 2, size[1] - height)
    pen.rectangle([x, y, x + width, y + height], fill=_DARK)
    pen.text((x + 2, y), mark.text, fill=mark.colour, font=font)


def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)
