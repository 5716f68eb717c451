"""Images and things to learn from, drawn from a data set."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.detector.proposals import Target

_LEAST_SIDE, _LEAST_IN_SIGHT = 4.0, 0.4  # of a thing's box that is worth learning [px, share]


@dataclass(frozen=True, slots=True)
class Views:
    """How images are shown to the network."""

    width: int = 160
    """Of a view [px]; its height is three quarters of it."""
    zoom: float = 2.0
    """Images are drawn at up to so many times the size at which they fill the view."""
    large: float = 0.2
    """Share of the iterations whose views are twice as wide, of a quarter as many images."""


class Batches(torch.utils.data.Dataset[tuple[Tensor, list[Target]]]):
    """Batch k is a function of the seed and k alone, so training can go on from anywhere."""

    def __init__(
        self, dataset: DetectionDataset, known: Sequence[str], *, views: Views, size: int, count: int, seed: int
    ) -> None:
        self._dataset, self._views, self._size, self._count, self._seed = dataset, views, size, count, seed
        self._labels = {name: number for number, name in enumerate(known)}

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, number: int) -> tuple[Tensor, list[Target]]:
        rng = np.random.default_rng([self._seed, number])
        large = rng.random() < self._views.large
        width = self._views.width * (2 if large else 1)
        size = max(self._size // 4, 1) if large else self._size
        shown = [self._view(self._index(number * self._size + k), width, rng) for k in range(size)]
        images = torch.from_numpy(np.stack([image for image, _ in shown])).permute(0, 3, 1, 2)
        return images.float() / 255, [target for _, target in shown]

    def _index(self, position: int) -> int:
        """Return the image at a position of an endless sequence in which each epoch is shuffled anew."""
        epoch, place = divmod(position, len(self._dataset))
        return _shuffled(self._seed, epoch, len(self._dataset))[place]

    def _view(self, index: int, width: int, rng: np.random.Generator) -> tuple[NDArray[np.uint8], Target]:
        most = round(self._views.width * self._views.zoom)
        image = self._dataset.image(index, width=max(most, width))
        full = self._dataset.size(index)
        height = round(width * 0.75)
        fit = min(width / full[0], height / full[1])
        scale = fit * math.exp(rng.uniform(0, math.log(max(most / width, 1.0)))) if rng.random() < 0.7 else fit
        view, corner = _placed(image, full, scale, (width, height), rng)
        boxes, labels, ignored = self._things(index, scale, corner, (width, height))
        if rng.random() < 0.5:
            view = view[:, ::-1]
            for each in (boxes, ignored):
                each[:, [0, 2]] = width - each[:, [2, 0]]
        return _lit(view, rng), Target(torch.from_numpy(boxes), torch.tensor(labels).long(), torch.from_numpy(ignored))

    def _things(
        self, index: int, scale: float, corner: tuple[int, int], view: tuple[int, int]
    ) -> tuple[NDArray[np.float32], list[int], NDArray[np.float32]]:
        boxes, labels, ignored = [], [], []
        for thing in self._dataset.annotations(index):
            label = self._labels.get(thing.category)
            if label is None:
                continue  # a thing that the detector must find without being told
            whole = np.array(thing.box, dtype=np.float32) * scale - np.array(corner * 2, dtype=np.float32)
            seen = whole.clip(0, np.array(view * 2, dtype=np.float32))
            sides = np.maximum(seen[2:] - seen[:2], 0)
            share = sides.prod() / max(float((whole[2:] - whole[:2]).prod()), 1e-6)
            if sides.min() <= 0:
                continue
            if thing.ignored or sides.min() < _LEAST_SIDE or share < _LEAST_IN_SIGHT:
                ignored.append(seen)
            else:
                boxes.append(seen)
                labels.append(label)
        rows = [np.array(each, dtype=np.float32).reshape(-1, 4) for each in (boxes, ignored)]
        return rows[0], labels, rows[1]


_orders: dict[tuple[int, int, int], list[int]] = {}


def _shuffled(seed: int, epoch: int, count: int) -> list[int]:
    key = (seed, epoch, count)
    if key not in _orders:
        _orders.clear()
        _orders[key] = np.random.default_rng([seed, epoch, 1]).permutation(count).tolist()
    return _orders[key]


def _placed(
    image: NDArray[np.uint8], full: tuple[int, int], scale: float, view: tuple[int, int], rng: np.random.Generator
) -> tuple[NDArray[np.uint8], tuple[int, int]]:
    """Return the image, scaled, behind a window, and the window's corner in the scaled image; grey where nothing is."""
    width, height = max(round(full[0] * scale), 1), max(round(full[1] * scale), 1)
    if image.shape[1::-1] != (width, height):
        shrinks = width < image.shape[1]
        image = np.asarray(
            cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR)
        )
    x, y = (int(rng.integers(0, max(size - wanted, 0) + 1)) for size, wanted in zip((width, height), view, strict=True))
    part = image[y : y + view[1], x : x + view[0]]
    if part.shape[:2] == view[::-1]:
        return part, (x, y)
    out = np.full((view[1], view[0], 3), 114, dtype=np.uint8)
    out[: part.shape[0], : part.shape[1]] = part
    return out, (x, y)


def _lit(view: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """Return the view under another exposure and slightly other light."""
    gains = rng.uniform(0.8, 1.2) * rng.uniform(0.93, 1.07, 3)
    return np.asarray((view * gains.astype(np.float32) + rng.uniform(-12, 12)).clip(0, 255), dtype=np.uint8)
