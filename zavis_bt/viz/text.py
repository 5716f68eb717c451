"""Texts as images for the scene."""

from __future__ import annotations

from functools import lru_cache
from io import BytesIO
from typing import TYPE_CHECKING, NamedTuple

from zavis_bt.recording.labels import font
from zavis_bt.viz.solids import Colour

if TYPE_CHECKING:
    from PIL import Image

_SIZE = 40  # of the font [px]; the screen shows it at about half of that


class TextImage(NamedTuple):
    """A text on a plate."""

    png: bytes
    aspect: float
    """Width by height."""


@lru_cache(maxsize=256)
def plate(text: str, detail: str = "", ink: Colour = (30, 36, 48), ground: Colour = (255, 255, 255)) -> TextImage:
    """Return a text, followed by a smaller grey one, on a rounded plate."""
    from PIL import Image, ImageDraw

    big, small, edge = font(_SIZE), font(_SIZE - 8), 14
    first = big.getlength(text)
    width = first + (big.getlength(" ") + small.getlength(detail) if detail else 0)
    image = Image.new("RGBA", (round(width) + 2 * edge, _SIZE + 2 * edge), (*ground, 0))
    pen = ImageDraw.Draw(image)
    pen.rounded_rectangle((0, 0, image.width - 1, image.height - 1), radius=14, fill=(*ground, 235))
    baseline = edge + _SIZE * 0.82
    pen.text((edge, baseline), text, fill=(*ink, 255), font=big, anchor="ls")
    if detail:
        after = edge + first + big.getlength(" ")
        pen.text((after, baseline), detail, fill=(112, 120, 134, 255), font=small, anchor="ls")
    return _encoded(image)


@lru_cache(maxsize=128)
def badge(text: str, ground: Colour) -> TextImage:
    """Return a short text in white on a disc."""
    from PIL import Image, ImageDraw

    side, sampling = 68, 3
    image = Image.new("RGBA", (side * sampling, side * sampling), (255, 255, 255, 0))
    pen = ImageDraw.Draw(image)
    pen.ellipse((0, 0, side * sampling - 1, side * sampling - 1), fill=(255, 255, 255, 255))
    rim = 4 * sampling
    pen.ellipse((rim, rim, side * sampling - 1 - rim, side * sampling - 1 - rim), fill=(*ground, 255))
    size = (40 if len(text) < 2 else 34 if len(text) < 3 else 26) * sampling
    middle = side * sampling / 2
    pen.text((middle, middle), text, fill=(255, 255, 255, 255), font=font(size), anchor="mm")
    return _encoded(image.resize((side, side), Image.Resampling.LANCZOS))


def _encoded(image: Image.Image) -> TextImage:
    buffer = BytesIO()
    image.save(buffer, "PNG", compress_level=1)
    return TextImage(buffer.getvalue(), image.width / image.height)
