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
    mosaic: float = 0.0
    """Share of the views that are put together of windows around known things."""
    grids: tuple[int, ...] = (2, 3)
    """So many windows across and down, drawn from these."""


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
        size = (width, round(width * 0.75))
        if rng.random() < self._views.mosaic:
            return self._mosaic(index, size, rng)
        full = self._dataset.size(index)
        fit = min(size[0] / full[0], size[1] / full[1])
        most = max(self._views.width * self._views.zoom / width, 1.0)
        scale = fit * math.exp(rng.uniform(0, math.log(most))) if rng.random() < 0.7 else fit
        room = [max(round(side * scale) - wanted, 0) for side, wanted in zip(full, size, strict=True)]
        return self._window(
            index, scale, (int(rng.integers(0, room[0] + 1)), int(rng.integers(0, room[1] + 1))), size, rng
        )

    def _mosaic(self, index: int, size: tuple[int, int], rng: np.random.Generator) -> tuple[NDArray[np.uint8], Target]:
        """Return a grid of windows, each around a known thing of another image."""
        grid = int(rng.choice(self._views.grids))
        part = (size[0] // grid, size[1] // grid)
        view, parts = np.full((size[1], size[0], 3), 114, dtype=np.uint8), []
        for number in range(grid * grid):
            image, target = self._around_thing(index, part, rng)
            x, y = number % grid * part[0], number // grid * part[1]
            view[y : y + part[1], x : x + part[0]] = image
            target.boxes += torch.tensor([x, y, x, y])
            target.ignored += torch.tensor([x, y, x, y])
            parts.append(target)
            index = self._with_known(rng)
        columns = (torch.cat([getattr(each, name) for each in parts]) for name in ("boxes", "labels", "ignored"))
        return view, Target(*columns)

    def _with_known(self, rng: np.random.Generator) -> int:
        """Return an image that shows a known thing, if a few tries find one."""
        for _ in range(8):
            index = int(rng.integers(len(self._dataset)))
            if any(each.category in self._labels and not each.ignored for each in self._dataset.annotations(index)):
                break
        return index

    def _around_thing(
        self, index: int, size: tuple[int, int], rng: np.random.Generator
    ) -> tuple[NDArray[np.uint8], Target]:
        full = self._dataset.size(index)
        things = [
            each for each in self._dataset.annotations(index) if each.category in self._labels and not each.ignored
        ]
        fit = min(size[0] / full[0], size[1] / full[1])
        if not things:
            return self._window(index, fit, (0, 0), size, rng)
        box = np.array(things[int(rng.integers(len(things)))].box)
        side = math.exp(rng.uniform(math.log(12), math.log(0.9 * size[1])))
        scale = float(np.clip(side / max(box[2:] - box[:2]), fit, 1.5 * self._views.width * self._views.zoom / full[0]))
        low = np.ceil(box[2:] * scale - size).clip(0)
        high = np.maximum(np.minimum(box[:2] * scale, np.array(full) * scale - size), low)
        x, y = (int(each) for each in rng.uniform(low, high))
        return self._window(index, scale, (x, y), size, rng)

    def _window(
        self, index: int, scale: float, corner: tuple[int, int], size: tuple[int, int], rng: np.random.Generator
    ) -> tuple[NDArray[np.uint8], Target]:
        image = self._dataset.image(index, width=round(self._views.width * max(self._views.zoom, 2.0)))
        view = _cut(image, self._dataset.size(index), scale, corner, size)
        boxes, labels, ignored = self._things(index, scale, corner, size)
        if rng.random() < 0.5:
            view = view[:, ::-1]
            for each in (boxes, ignored):
                each[:, [0, 2]] = size[0] - each[:, [2, 0]]
        return lit(view, rng), Target(torch.from_numpy(boxes), torch.tensor(labels).long(), torch.from_numpy(ignored))

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


def _cut(
    image: NDArray[np.uint8], full: tuple[int, int], scale: float, corner: tuple[int, int], view: tuple[int, int]
) -> NDArray[np.uint8]:
    """Return a window of an image, scaled; grey where nothing is.

    Args:
        image: Perhaps scaled down already.
        full: Width and height of the full image.
        scale: Of the full image.
        corner: Of the window, in the scaled image.
        view: Width and height of the window.
    """
    factor = scale * full[0] / image.shape[1]
    x0, y0 = (int(each / factor) for each in corner)
    x1, y1 = (math.ceil((each + side) / factor) + 1 for each, side in zip(corner, view, strict=True))
    part = image[y0:y1, x0:x1]
    wide, high = (max(round(side * factor), 1) for side in part.shape[1::-1])
    how = cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR
    part = np.asarray(cv2.resize(part, (wide, high), interpolation=how))
    x, y = round(corner[0] - x0 * factor), round(corner[1] - y0 * factor)
    part = part[max(y, 0) : max(y, 0) + view[1], max(x, 0) : max(x, 0) + view[0]]
    if part.shape[:2] == view[::-1]:
        return part
    out = np.full((view[1], view[0], 3), 114, dtype=np.uint8)
    out[: part.shape[0], : part.shape[1]] = part
    return out


def lit(view: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """Return an image under another exposure and slightly other light."""
    gains = rng.uniform(0.8, 1.2) * rng.uniform(0.93, 1.07, 3)
    return np.asarray((view * gains.astype(np.float32) + rng.uniform(-12, 12)).clip(0, 255), dtype=np.uint8)
