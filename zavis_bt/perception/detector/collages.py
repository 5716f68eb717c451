"""Collages of known things: views crowded with what has a label, from which classes are learnt many times faster."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from zavis_bt.perception.datasets import Annotation, DetectionDataset
from zavis_bt.perception.detector.proposals import Target
from zavis_bt.types import Box

_GRIDS = ((2, 2), (3, 2), (3, 3), (4, 3), (5, 4))  # columns and rows of a collage
_PATCH = 80  # side of the patches kept [px]
_READ_WIDTH = 320  # of the images they are cut from [px]
_MARGIN = 0.45  # of the box's longer side, kept round it on each side
_LEAST_VISIBLE = 0.65  # share of a thing that is in sight where it is cut out
_LEAST_SIDE = 5.0  # of a box in a collage [px]
_MOST = 20_000  # patches; they are kept in memory


class Collages:
    """Batch k is a function of the seed and k alone. A patch is a square round a thing, with what is beside it.

    An image of a home shows one or two known things among ten others; a collage shows up to twenty, at the same cost.
    """

    def __init__(self, dataset: DetectionDataset, known: Sequence[str], *, width: int, size: int, seed: int) -> None:
        """Cut the patches, which takes a second for some hundred images.

        Args:
            dataset: Whole things of the known classes are taken from it.
            known: The classes.
            width: Of the collages [px]; their height is three quarters of it.
            size: Collages in a batch.
            seed: Of the order.
        """
        self._shape, self._size, self._seed = (round(width * 0.75), width), size, seed
        patches, boxes, labels = _cut(dataset, {name: number for number, name in enumerate(known)})
        self._patches, self._boxes, self._labels = patches, boxes, labels
        frequency = np.bincount(labels, minlength=len(known)).clip(1)
        weights = 1 / np.sqrt(frequency[labels])
        self._chances = np.cumsum(weights / weights.sum()) if len(labels) else weights

    def __len__(self) -> int:
        """Return the number of patches."""
        return len(self._labels)

    def __getitem__(self, number: int) -> tuple[Tensor, list[Target]]:
        """Return images (n, 3, h, w) from 0 to 1 and what they show."""
        rng = np.random.default_rng([self._seed, 7, number])
        made = [self._collage(rng) for _ in range(self._size)]
        images = torch.from_numpy(np.stack([image for image, _ in made])).permute(0, 3, 1, 2)
        return images.float() / 255, [target for _, target in made]

    def _collage(self, rng: np.random.Generator) -> tuple[NDArray[np.uint8], Target]:
        height, width = self._shape
        image = np.full((height, width, 3), 114, dtype=np.uint8)
        columns, rows = _GRIDS[int(rng.integers(len(_GRIDS)))]
        xs, ys = np.linspace(0, width, columns + 1).astype(int), np.linspace(0, height, rows + 1).astype(int)
        chosen = np.searchsorted(self._chances, rng.random(columns * rows)).clip(max=len(self._labels) - 1)
        boxes = np.zeros((len(chosen), 4), dtype=np.float32)
        for k, patch in enumerate(chosen.tolist()):
            x, y = int(xs[k % columns]), int(ys[k // columns])
            cell = (int(xs[k % columns + 1]) - x, int(ys[k // columns + 1]) - y)
            boxes[k] = self._paste(image, patch, (x, y), cell, rng)
        exposed = (image * rng.uniform(0.8, 1.2, 3).astype(np.float32)).clip(0, 255).astype(np.uint8)
        wide = (boxes[:, 2:] - boxes[:, :2]).min(axis=1) >= _LEAST_SIDE
        labels = torch.from_numpy(self._labels[chosen[wide]])
        return exposed, Target(torch.from_numpy(boxes[wide]), labels, torch.from_numpy(boxes[~wide]))

    def _paste(
        self,
        image: NDArray[np.uint8],
        patch: int,
        corner: tuple[int, int],
        cell: tuple[int, int],
        rng: np.random.Generator,
    ) -> NDArray[np.float32]:
        """Draw a patch into its cell, mirrored or not and cut to about its thing, and return the thing's box."""
        box, (x, y) = self._boxes[patch], corner
        room = rng.uniform(0.1, 1.0, 4) * np.array([*box[:2], *(_PATCH - box[2:])])
        x0, y0 = np.floor(box[:2] - room[:2]).clip(0).astype(int)
        x1, y1 = np.ceil(box[2:] + room[2:]).clip(max=_PATCH).astype(int)
        part = self._patches[patch, y0:y1, x0:x1]
        scale = min(cell[0] / part.shape[1], cell[1] / part.shape[0])
        size = max(int(part.shape[1] * scale), 1), max(int(part.shape[0] * scale), 1)
        drawn = cv2.resize(part, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
        edges = (box - np.array([x0, y0, x0, y0])) * np.array([size[0] / part.shape[1], size[1] / part.shape[0]] * 2)
        if rng.random() < 0.5:
            drawn, edges = drawn[:, ::-1], np.array([size[0] - edges[2], edges[1], size[0] - edges[0], edges[3]])
        image[y : y + size[1], x : x + size[0]] = drawn
        return np.asarray(edges + np.array([x, y, x, y]), dtype=np.float32)


def _cut(
    dataset: DetectionDataset, numbers: dict[str, int]
) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.int64]]:
    """Return patches (n, side, side, 3), the things' boxes in them (n, 4) and their labels (n,)."""
    patches: list[NDArray[np.uint8]] = []
    boxes: list[tuple[float, float, float, float]] = []
    labels: list[int] = []
    for index in range(len(dataset)):
        wanted = [thing for thing in dataset.annotations(index) if _is_good(thing, numbers)]
        if not wanted:
            continue
        if len(labels) >= _MOST:
            break
        image = dataset.image(index, width=_READ_WIDTH)
        scale = image.shape[1] / dataset.size(index)[0]
        for thing in wanted:
            patch, box = _patch(image, Box(*(edge * scale for edge in thing.box)))
            patches.append(patch)
            boxes.append(box)
            labels.append(numbers[thing.category])
    if not labels:
        return np.zeros((0, _PATCH, _PATCH, 3), np.uint8), np.zeros((0, 4), np.float32), np.zeros(0, np.int64)
    return np.stack(patches), np.array(boxes, dtype=np.float32), np.array(labels, dtype=np.int64)


def _is_good(thing: Annotation, numbers: dict[str, int]) -> bool:
    return thing.category in numbers and not thing.ignored and thing.visible >= _LEAST_VISIBLE


def _patch(image: NDArray[np.uint8], box: Box) -> tuple[NDArray[np.uint8], tuple[float, float, float, float]]:
    """Return a square round a box, and the box in it; grey where it goes beyond the image."""
    side = max(max(box.x1 - box.x0, box.y1 - box.y0) * (1 + 2 * _MARGIN), 4.0)
    x, y, scale = (box.x0 + box.x1 - side) / 2, (box.y0 + box.y1 - side) / 2, _PATCH / side
    move = np.array([[scale, 0, -x * scale], [0, scale, -y * scale]])
    shrinks = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    patch = cv2.warpAffine(image, move, (_PATCH, _PATCH), flags=shrinks, borderValue=(114, 114, 114))
    return np.asarray(patch, dtype=np.uint8), (
        (box.x0 - x) * scale,
        (box.y0 - y) * scale,
        (box.x1 - x) * scale,
        (box.y1 - y) * scale,
    )
