"""Boxes in images."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TypeVar

from zavis_bt.types import Box, CameraIntrinsics

T = TypeVar("T")

_SMALLEST = 1.0  # side of the smallest box that shows anything [px]
_BORDER = 1.5  # boxes that end this near the image's edge probably go on beyond it [px]


def clip(box: Box, intrinsics: CameraIntrinsics) -> Box | None:
    """Return the part of the box inside the image, or None if it is not finite or less than a pixel is left."""
    if not all(map(math.isfinite, box)):
        return None
    x0, x1 = max(box.x0, 0.0), min(box.x1, float(intrinsics.width))
    y0, y1 = max(box.y0, 0.0), min(box.y1, float(intrinsics.height))
    return Box(x0, y0, x1, y1) if x1 - x0 >= _SMALLEST and y1 - y0 >= _SMALLEST else None


def touches_border(box: Box, intrinsics: CameraIntrinsics) -> bool:
    """Return whether the image's edge cuts the box, so that it shows only a part of the thing."""
    right, bottom = intrinsics.width - box.x1, intrinsics.height - box.y1
    return min(box.x0, box.y0, right, bottom) <= _BORDER


def suppress(items: Iterable[T], box: Callable[[T], Box], max_iou: float) -> list[T]:
    """Return the items, best first, without those that overlap a better one by more than ``max_iou``."""
    kept: list[T] = []
    for item in items:
        if all(box(item).iou(box(better)) <= max_iou for better in kept):
            kept.append(item)
    return kept
