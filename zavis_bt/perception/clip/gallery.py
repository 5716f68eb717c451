"""Labelled crops to measure a matcher with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from zavis_bt.errors import InputError
from zavis_bt.perception.clip.backgrounds import draw_backgrounds
from zavis_bt.perception.clip.crops import cut_out
from zavis_bt.perception.clip.model import ClipModel
from zavis_bt.perception.datasets import DetectionDataset

LEAST_SIDE = 12.0
"""Narrower things are no crops [px at 640 px width]."""


@dataclass(frozen=True, slots=True)
class Gallery:
    """Crops as vectors, with what they show."""

    vectors: Tensor
    """(n, d) unit length."""
    categories: NDArray[np.str_]
    """(n,) names; an empty one is a crop of background."""
    colours: NDArray[np.str_]
    """(n,) names, or empty."""
    sides: NDArray[np.float64]
    """(n,) shorter side of the box [px at 640 px width]."""
    visible: NDArray[np.float64]
    """(n,) share in sight."""


def encode_gallery(
    model: ClipModel,
    dataset: DetectionDataset,
    *,
    backgrounds: int = 1,
    width: int | None = None,
    report: Callable[[int, int], None] | None = None,
) -> Gallery:
    """Return all things of a data set that count, and some background, as vectors.

    Args:
        model: Encodes them.
        dataset: Images and boxes.
        backgrounds: Boxes without a thing, of each image.
        width: To which images are scaled down first, as if of a coarser camera [px].
        report: Called with the number of images done and of all.

    Raises:
        InputError: No thing counts.
    """
    rng = np.random.default_rng(0)
    vectors: list[Tensor] = []
    rows: list[tuple[str, str, float, float]] = []
    for index in range(len(dataset)):
        full = dataset.size(index)
        things = dataset.annotations(index)
        boxes = np.array([thing.box for thing in things], dtype=np.float64).reshape(-1, 4)
        counts = [thing for thing in things if not thing.ignored and shorter_side(thing.box, full) >= LEAST_SIDE]
        empty = [box for box, _ in draw_backgrounds(boxes, full, backgrounds, rng)]
        crops = np.array([*(thing.box for thing in counts), *empty], dtype=np.float64).reshape(-1, 4)
        if len(crops):
            rgb = dataset.image(index, width=width)
            vectors.append(model.encode_images(cut_out(rgb, crops * (rgb.shape[1] / full[0]))))
        rows += [(thing.category, thing.colour or "", shorter_side(thing.box, full), thing.visible) for thing in counts]
        rows += [("", "", shorter_side(box, full), 1.0) for box in empty]
        if report:
            report(index + 1, len(dataset))
    if not any(row[0] for row in rows):
        raise InputError(f"{dataset.name}: shows nothing that counts (things of at least {LEAST_SIDE:g} px)")
    names, colours, sides, visible = zip(*rows, strict=True)
    return Gallery(torch.cat(vectors), np.array(names), np.array(colours), np.array(sides), np.array(visible))


def shorter_side(box: NDArray[np.float64] | tuple[float, ...], size: tuple[int, int]) -> float:
    """Return the shorter side of a box in an image of that width and height [px at 640 px width]."""
    return float(min(box[2] - box[0], box[3] - box[1])) * 640 / size[0]
