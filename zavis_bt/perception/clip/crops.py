"""From boxes in an image to what an image tower reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

RgbImage = NDArray[np.uint8]

_UPSAMPLING = {"bicubic": cv2.INTER_CUBIC, "bilinear": cv2.INTER_LINEAR, "nearest": cv2.INTER_NEAREST}


@dataclass(frozen=True, slots=True)
class Preprocessing:
    """How a model wants its images."""

    size: int
    """Side of the square it reads [px]."""
    mean: tuple[float, float, float]
    """Of the colours, 0 to 1."""
    std: tuple[float, float, float]
    """Of the colours, 0 to 1."""
    interpolation: str = "bicubic"
    """For enlarging: ``bicubic``, ``bilinear`` or ``nearest``; shrinking averages."""

    def apply(self, crops: Sequence[RgbImage]) -> Tensor:
        """Return crops as (n, 3, size, size) float32: shrunk or enlarged as a whole, padded to squares, normalised.

        CLIP's own preprocessing scales the shorter side and cuts the middle out, which would cut the ends off long
        things. The padding is the mean colour, which is zero for the model.
        """
        mean = np.asarray(self.mean, dtype=np.float32) * 255
        padding = np.round(mean).astype(np.uint8)
        squares = np.empty((len(crops), self.size, self.size, 3), dtype=np.uint8)
        for square, crop in zip(squares, crops, strict=True):
            self._paint(square, crop, padding)
        scale = 1 / (np.asarray(self.std, dtype=np.float32) * 255)
        images = (torch.from_numpy(squares).float() - torch.from_numpy(mean)) * torch.from_numpy(scale)
        return images.permute(0, 3, 1, 2)

    def _paint(self, square: RgbImage, crop: RgbImage, padding: RgbImage) -> None:
        height, width = crop.shape[:2]
        factor = self.size / max(height, width)
        h, w = max(round(height * factor), 1), max(round(width * factor), 1)
        how = cv2.INTER_AREA if factor < 1 else _UPSAMPLING[self.interpolation]
        top, left = (self.size - h) // 2, (self.size - w) // 2
        square[:] = padding
        square[top : top + h, left : left + w] = cv2.resize(crop, (w, h), interpolation=how)


def cut_out(rgb: RgbImage, boxes: NDArray[np.floating]) -> list[RgbImage]:
    """Return the patches of an image inside boxes, at least one pixel each.

    Args:
        rgb: (h, w, 3).
        boxes: (n, 4) ``x0, y0, x1, y1`` [px], finite; parts outside the image are left out.
    """
    height, width = rgb.shape[:2]
    rows = np.asarray(boxes, dtype=np.float64).reshape(-1, 4)
    x0, y0 = (np.clip(rows[:, k], 0, side - 1).astype(int) for k, side in ((0, width), (1, height)))
    x1, y1 = (np.ceil(rows[:, k]).astype(int) for k in (2, 3))
    x1, y1 = np.clip(x1, x0 + 1, width), np.clip(y1, y0 + 1, height)
    return [rgb[top:bottom, left:right] for left, top, right, bottom in zip(x0, y0, x1, y1, strict=True)]
