"""What a data set of labelled images offers, whatever form it is kept in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import Box


@dataclass(frozen=True, slots=True)
class Annotation:
    """One thing in an image."""

    box: Box
    """In pixels of the full image."""
    category: str
    """By this project's name (`project_name`)."""
    colour: str | None = None
    """A basic colour's name, if the data set tells it."""
    visible: float = 1.0
    """Share of the thing that is in sight, 0 to 1."""
    ignored: bool = False
    """Too small, too hidden or too many to count: a detector need not find it and may."""


class DetectionDataset(Protocol):
    """Images with the boxes and categories of what they show. Any thread may ask."""

    @property
    def name(self) -> str:
        """For people: where it comes from."""

    @property
    def categories(self) -> tuple[str, ...]:
        """All names its annotations may have."""

    @property
    def rendered(self) -> bool:
        """Whether a simulator drew the images."""

    def __len__(self) -> int:
        """Return the number of images."""

    def image(self, index: int, *, width: int | None = None) -> NDArray[np.uint8]:
        """Return an image, (h, w, 3) uint8 RGB, scaled down to ``width`` if it is wider.

        Raises:
            InputError: The file is gone, corrupt, or not of the size that the data set tells.
        """

    def annotations(self, index: int) -> tuple[Annotation, ...]:
        """Return what an image shows, in pixels of the full image."""

    def size(self, index: int) -> tuple[int, int]:
        """Return width and height of the full image [px]."""

    def path(self, index: int) -> str:
        """Return the file of an image."""
