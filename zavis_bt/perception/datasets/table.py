"""Boxes of many images as columns: checked at once, handed out by image."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets.dataset import Annotation
from zavis_bt.perception.datasets.pictures import read_picture
from zavis_bt.types import Box

_OVERSHOOT = 2.0  # of a box beyond the image's edge that is rounding [px]
_FEW = 1e-4  # share of boxes that may be wrong: COCO's own 2017 files have some without area


@dataclass(frozen=True, slots=True)
class Columns:
    """All boxes of a data set; row k of each column belongs to box k."""

    image: NDArray[np.intp]
    """(n,) index of the image."""
    box: NDArray[np.float64]
    """(n, 4) x0, y0, x1, y1 [px]."""
    category: Sequence[str]
    ignored: NDArray[np.bool_]
    colour: Sequence[str | None] | None = None
    visible: NDArray[np.float64] | None = None


class TableDataset:
    """Images on disk and a table of their boxes."""

    def __init__(
        self,
        name: str,
        files: Sequence[Path],
        sizes: NDArray[np.intp],
        columns: Columns,
        place: Callable[[int], str],
        *,
        rendered: bool = False,
        categories: Sequence[str] = (),
    ) -> None:
        """Check and index the boxes.

        Args:
            name: Where it comes from.
            files: n images.
            sizes: (n, 2) their widths and heights [px].
            columns: All boxes.
            place: Returns where box k stands, to begin an error message with.
            rendered: Whether a simulator drew the images.
            categories: Names beside those of the boxes.

        Raises:
            InputError: There are no images or no boxes, or a box lies outside its image or has no area.
        """
        if not len(files) or not len(columns.image):
            raise InputError(f"{name}: holds no {'boxes' if len(files) else 'images'} (an empty data set)")
        box, good = _checked(columns, sizes, place)
        self.name, self.rendered = name, rendered
        self.categories = tuple(dict.fromkeys([*categories, *columns.category]))
        self._files, self._sizes, self._columns, self._box = files, sizes, columns, box
        kept = np.flatnonzero(good)
        self._rows = kept[np.argsort(columns.image[kept], kind="stable")]
        self._starts = np.searchsorted(columns.image[self._rows], np.arange(len(files) + 1))

    def __len__(self) -> int:
        return len(self._files)

    def image(self, index: int, *, width: int | None = None) -> NDArray[np.uint8]:
        """Return an image, (h, w, 3) uint8 RGB, scaled down to ``width`` if it is wider.

        Raises:
            InputError: The file is gone, corrupt, or not of the size that the data set tells.
        """
        return read_picture(self._files[index], self.size(index), width)

    def annotations(self, index: int) -> tuple[Annotation, ...]:
        """Return what an image shows, in pixels of the full image."""
        index = range(len(self))[index]
        return tuple(self._annotation(row) for row in self._rows[self._starts[index] : self._starts[index + 1]])

    def size(self, index: int) -> tuple[int, int]:
        """Return width and height of the full image [px]."""
        width, height = self._sizes[index]
        return int(width), int(height)

    def path(self, index: int) -> str:
        """Return the file of an image."""
        return str(self._files[index])

    def _annotation(self, row: int) -> Annotation:
        table = self._columns
        return Annotation(
            Box(*self._box[row].tolist()),
            table.category[row],
            table.colour[row] if table.colour is not None else None,
            float(table.visible[row]) if table.visible is not None else 1.0,
            bool(table.ignored[row]),
        )


def _checked(
    columns: Columns, sizes: NDArray[np.intp], place: Callable[[int], str]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the boxes cut to their images, and which are good: all, or all but a few of very many."""
    edges = sizes[columns.image].astype(np.float64)
    low, high = columns.box[:, :2], columns.box[:, 2:]
    with np.errstate(invalid="ignore"):
        has_area = np.all((high > low) & np.isfinite(low) & np.isfinite(high), axis=1)
        inside = np.all((low >= -_OVERSHOOT) & (high <= edges + _OVERSHOOT) & (low < edges) & (high > 0), axis=1)
    good = has_area & inside
    bad = np.flatnonzero(~good)
    if len(bad) > _FEW * len(good):
        k = int(bad[0])
        x0, y0, x1, y1 = (f"{value:g}" for value in columns.box[k])
        fault = "has no area" if not has_area[k] else "reaches out of the image"
        raise InputError(
            f"{place(k)}: box {x0}, {y0}, {x1}, {y1} {fault} ({edges[k, 0]:g}×{edges[k, 1]:g} px; "
            f"such boxes: {len(bad)} of {len(good)})"
        )
    return np.hstack([np.clip(low, 0.0, edges), np.clip(high, 0.0, edges)]), good
