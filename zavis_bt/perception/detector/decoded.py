"""Images decoded once, for trainings on few processors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import Annotation, DetectionDataset


class Decoded:
    """A data set whose images, all of one size and scaled down, are in one file on disk."""

    def __init__(
        self, dataset: DetectionDataset, file: Path, width: int, progress: Callable[[int], None] = lambda done: None
    ) -> None:
        """Decode all images unless the file is there.

        Raises:
            InputError: An image cannot be read, or the file holds another number of images.
        """
        self._dataset, self._width = dataset, width
        if not file.exists():
            _decode(dataset, file, width, progress)
        self._images = np.load(file, mmap_mode="r")
        if len(self._images) != len(dataset):
            raise InputError(f"{file}: holds {len(self._images)} images, not the {len(dataset)} of {dataset.name}")
        self._things = [dataset.annotations(index) for index in range(len(dataset))]

    @property
    def name(self) -> str:
        """For people: where it comes from."""
        return self._dataset.name

    @property
    def categories(self) -> tuple[str, ...]:
        """All names its annotations may have."""
        return self._dataset.categories

    @property
    def rendered(self) -> bool:
        """Whether a simulator drew the images."""
        return self._dataset.rendered

    def __len__(self) -> int:
        """Return the number of images."""
        return len(self._dataset)

    def image(self, index: int, *, width: int | None = None) -> NDArray[np.uint8]:
        """Return an image, (h, w, 3) uint8 RGB, of the width that was decoded or a lesser one."""
        image: NDArray[np.uint8] = self._images[index]
        if width is None or width >= image.shape[1]:
            return image
        size = (width, max(round(image.shape[0] * width / image.shape[1]), 1))
        return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)

    def annotations(self, index: int) -> tuple[Annotation, ...]:
        """Return what an image shows, in pixels of the full image."""
        return self._things[index]

    def size(self, index: int) -> tuple[int, int]:
        """Return width and height of the full image [px]."""
        return self._dataset.size(index)

    def path(self, index: int) -> str:
        """Return the file of an image."""
        return self._dataset.path(index)


def are_of_one_size(dataset: DetectionDataset) -> bool:
    """Return whether all images have the same width and height, as those of one camera have."""
    return len({dataset.size(index) for index in range(len(dataset))}) == 1


def _decode(dataset: DetectionDataset, file: Path, width: int, progress: Callable[[int], None]) -> None:
    part = file.with_name(f".{file.name}.part")
    shape = dataset.image(0, width=width).shape
    images = np.lib.format.open_memmap(part, mode="w+", dtype=np.uint8, shape=(len(dataset), *shape))
    for index in range(len(dataset)):
        images[index] = dataset.image(index, width=width)
        progress(index + 1)
    images.flush()
    part.rename(file)
