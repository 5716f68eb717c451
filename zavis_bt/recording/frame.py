"""What stands around the map: title, scale bar and legend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from zavis_bt.recording import marks
from zavis_bt.recording.canvas import Canvas, star
from zavis_bt.recording.labels import font, text_width
from zavis_bt.types import FloatArray, Landmark, Pose2D

if TYPE_CHECKING:
    from PIL import ImageDraw

_TITLE, _LINE, _EDGE, _GAP, _ICON = 48, 40, 18, 18, 34  # [px]
_TEXTS = {
    "start": "start",
    "trajectory": "path, early to late",
    "landmark": "landmark, entropy [nat]",
    "viewpoint": "viewpoint visited",
    "frontier": "frontier visited",
    "candidate": "candidate",
    "found": "found",
}
_INK, _FRAME = (30, 36, 48), (198, 203, 212)


def framed(picture: NDArray[np.uint8], scale: float, title: str, kinds: Sequence[str]) -> NDArray[np.uint8]:
    """Put a title above a picture, a scale bar and a legend below.

    Args:
        picture: (h, w, 3) rgb.
        scale: Pixels a metre.
        title: No title line if empty.
        kinds: What the legend explains, of `zavis_bt.recording.marks.KINDS`.
    """
    from PIL import Image, ImageDraw

    bar = _bar_length(picture.shape[1] / scale)
    indent = bar * scale + text_width(f"{bar:g} m", 14) + 8 + _GAP
    widest = max([indent + _width(kind) for kind in kinds] + [indent, text_width(title, 20)])
    width = max(picture.shape[1], int(np.ceil(widest + 2 * _EDGE)))
    lines = _lines(kinds, width - 2 * _EDGE, indent)
    top = _TITLE if title else 0
    page = Image.new("RGB", (width, top + picture.shape[0] + _LINE * len(lines) + 8), (255, 255, 255))
    left = (width - picture.shape[1]) // 2
    page.paste(Image.fromarray(picture), (left, top))
    pen = ImageDraw.Draw(page)
    pen.rectangle((left, top, left + picture.shape[1] - 1, top + picture.shape[0] - 1), outline=_FRAME)
    if title:
        pen.text((_EDGE, top / 2 + 1), title, fill=_INK, font=font(20), anchor="lm")
    middle = top + picture.shape[0] + _LINE / 2 + 4
    _draw_bar(pen, (_EDGE, middle), bar, scale)
    for number, line in enumerate(lines):
        for u, kind in line:
            v = middle + number * _LINE
            page.paste(Image.fromarray(_icon(kind)), (round(u), round(v) - _ICON // 2))
            pen.text((u + _ICON + 6, v), _TEXTS[kind], fill=_INK, font=font(14), anchor="lm")
    return np.asarray(page, dtype=np.uint8)


def _width(kind: str) -> float:
    return _ICON + 6 + text_width(_TEXTS[kind], 14)


def _lines(kinds: Sequence[str], width: float, indent: float) -> list[list[tuple[float, str]]]:
    lines: list[list[tuple[float, str]]] = [[]]
    u = indent
    for kind in kinds:
        if u > indent and u + _width(kind) > width:
            lines.append([])
            u = indent
        lines[-1].append((_EDGE + u, kind))
        u += _width(kind) + _GAP
    return lines


def _bar_length(shown: float) -> float:
    """Return a round length [m] of at most a fifth of what is shown."""
    choices = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
    return max((choice for choice in choices if choice <= shown / 5), default=choices[0])


def _draw_bar(pen: ImageDraw.ImageDraw, at: tuple[float, float], bar: float, scale: float) -> None:
    (u, v), length = at, bar * scale
    pen.line((u, v, u + length, v), fill=_INK, width=2)
    for end in (u, u + length):
        pen.line((end, v - 5, end, v + 5), fill=_INK, width=2)
    pen.text((u + length + 8, v), f"{bar:g} m", fill=_INK, font=font(14), anchor="lm")


def _icon(kind: str) -> NDArray[np.uint8]:
    half = _ICON / 2
    canvas = Canvas((-half, -half, half, half), 1.0)  # a pixel is a metre here
    canvas.polygon(np.array([[-9, -9], [99, -9], [99, 99], [-9, 99]], dtype=np.float64), marks.WHITE, marks.WHITE, 1)
    match kind:
        case "start":
            marks.draw_start(canvas, Pose2D(0, 0))
        case "trajectory":
            points: FloatArray = np.column_stack((np.linspace(-15, 15, 31), 4 * np.sin(np.linspace(-3, 3, 31))))
            marks.draw_trajectory(canvas, points)
        case "landmark":
            for x, p in ((-8.0, 1.0), (8.0, 0.5)):
                marks.draw_landmarks(canvas, [Landmark(0, (("a", p), ("b", 1 - p)), (x, 0, 0), 7.0, 1)])
        case "viewpoint":
            marks.draw_visited(canvas, [Pose2D(-4, 0)])
        case "frontier":
            marks.draw_frontiers(canvas, np.zeros((1, 2)))
        case "candidate":
            marks.draw_candidates(canvas, [(0.0, 0.0)])
        case "found":
            canvas.polygon(star(np.array([half, half]), 15.0), marks.FOUND, marks.FOUND_EDGE, 2.0)
    return canvas.finish()
