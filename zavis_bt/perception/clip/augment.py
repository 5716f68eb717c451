"""Random variants of patches: boxes as a detector would set them, light, sharpness as of far cameras."""

from __future__ import annotations

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor

_SIDES = (8, 12, 16, 24, 32, 44)  # to which blurred crops are shrunk in between [px]


@dataclass(frozen=True, slots=True)
class Augmentation:
    """How far variants go."""

    shift: float = 0.07
    """Standard deviation of each edge of the box, as a share of its side."""
    brightness: float = 0.15
    contrast: float = 0.15
    tint: float = 0.04
    """Most that the factor of all channels (contrast) and of each (tint) differs from 1; brightness is added, as a
    share of half the range. With weaker ones, colours are told worse that a category was never shown in."""
    repainted: float = 0.2
    """Share of crops, of what comes in many colours, that are shown in others, which have no name then."""
    coarse: float = 0.3
    """Share of crops shown as the camera would have seen them with fewer pixels."""
    least_share: float = 0.3
    """Of pixels along a side that coarse crops keep: 0.25 shows 640 px wide frames as of a camera of 160 px."""


def boxes_near(boxes: Tensor, limits: Tensor, augmentation: Augmentation, rng: torch.Generator) -> Tensor:
    """Return boxes (n, 4) with edges moved at random, inside the limits (n, 4), all as shares of the patch."""
    sides = (boxes[:, 2:] - boxes[:, :2]).repeat(1, 2)
    moved = boxes + sides * augmentation.shift * torch.randn(boxes.shape, generator=rng).clamp(-2.2, 2.2)
    moved = moved.clamp(0, 1).clamp(limits[:, :2].repeat(1, 2), limits[:, 2:].repeat(1, 2))
    narrow = (moved[:, 2:] - moved[:, :2] < 0.3 * sides[:, :2]).any(dim=1, keepdim=True)
    return torch.where(narrow, boxes, moved)


def cut_squares(patches: Tensor, boxes: Tensor, mirrored: Tensor, size: int) -> tuple[Tensor, Tensor]:
    """Return what boxes in patches show, as wholes on squares, and where on the squares the boxes are.

    Args:
        patches: (n, 3, s, s), 0 to 255.
        boxes: (n, 4) as shares of the patch.
        mirrored: (n,) whether left and right are swapped.
        size: Side of the squares [px].

    Returns:
        (n, 3, size, size) float32, 0 to 255; and (n, 1, size, size) bool, false beside long boxes.
    """
    middle, sides = (boxes[:, 2:] + boxes[:, :2]) / 2, boxes[:, 2:] - boxes[:, :2]
    half = sides.amax(dim=1, keepdim=True) / 2
    along = (torch.arange(size, device=patches.device) + 0.5) / size * 2 - 1
    flip = torch.where(mirrored, -1.0, 1.0)[:, None]
    x = middle[:, :1] + half * along * flip
    y = middle[:, 1:] + half * along
    grid = torch.stack(torch.broadcast_tensors(x[:, None, :], y[:, :, None]), dim=-1) * 2 - 1
    squares = F.grid_sample(patches, grid, mode="bilinear", padding_mode="border", align_corners=False)
    inside_x = (x - middle[:, :1]).abs() <= sides[:, :1] / 2
    inside_y = (y - middle[:, 1:]).abs() <= sides[:, 1:] / 2
    return squares, inside_y[:, None, :, None] & inside_x[:, None, None, :]


def vary_light(images: Tensor, augmentation: Augmentation, rng: torch.Generator) -> Tensor:
    """Return images (n, 3, h, w), 0 to 255, in other light."""
    n = len(images)
    gain = 1 + augmentation.contrast * _spread((n, 1, 1, 1), rng) + augmentation.tint * _spread((n, 3, 1, 1), rng)
    offset = 255 * augmentation.brightness * _spread((n, 1, 1, 1), rng) * 0.5
    return (images * gain + offset).clamp(0, 255)


def repaint(images: Tensor, chosen: Tensor, rng: torch.Generator) -> Tensor:
    """Return images (n, 3, h, w) of which the chosen (n,) have their colours' channels shifted or swapped, in place.

    Red becomes green or blue, yellow may become cyan; white, grey and black stay.
    """
    orders = torch.tensor([(0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)])
    rows = torch.nonzero(chosen)[:, 0]
    order = orders[torch.randint(len(orders), (len(rows),), generator=rng)]
    images[rows] = images[rows[:, None], order]
    return images


def coarsen(images: Tensor, lengths: Tensor, augmentation: Augmentation, rng: torch.Generator) -> Tensor:
    """Return images (n, 3, s, s) of which some are as coarse as the camera would have shown them with fewer pixels.

    Args:
        images: To be changed in place.
        lengths: (n,) longer side of what they show in its camera's image [px].
        augmentation: How many and how far.
        rng: Source of the draws.
    """
    size = images.shape[-1]
    share = augmentation.least_share ** torch.rand(len(images), generator=rng)
    chosen = torch.rand(len(images), generator=rng) < augmentation.coarse
    target = torch.where(chosen, lengths * share, torch.inf)
    steps = torch.tensor([s for s in _SIDES if s < size])
    nearest = (target.clamp(min=1).log()[:, None] - steps.log()[None]).abs().argmin(dim=1)
    for k, side in enumerate(steps.tolist()):
        rows = torch.nonzero((nearest == k) & (target < size * 0.9))[:, 0].to(images.device)
        if len(rows):
            small = F.interpolate(images[rows], size=(side, side), mode="area")
            images[rows] = F.interpolate(small, size=(size, size), mode="bilinear", align_corners=False)
    return images


def _spread(shape: tuple[int, ...], rng: torch.Generator) -> Tensor:
    return torch.rand(shape, generator=rng) * 2 - 1
