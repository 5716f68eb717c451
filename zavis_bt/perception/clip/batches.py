"""Batches of crops and captions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from zavis_bt.errors import InputError
from zavis_bt.perception.clip.augment import boxes_near, coarsen, cut_squares, repaint, vary_light
from zavis_bt.perception.clip.captions import NO_COLOUR, CaptionWriter
from zavis_bt.perception.clip.colours import Pair, many_coloured, untold_pairs
from zavis_bt.perception.clip.crops import Preprocessing
from zavis_bt.perception.clip.heads import Labels
from zavis_bt.perception.clip.patches import Patches
from zavis_bt.perception.clip.settings import MatcherSettings


@dataclass(frozen=True, slots=True)
class CropBatch:
    """Crops with captions."""

    images: Tensor
    """(n, 3, s, s) as the image tower reads them."""
    labels: Labels
    texts: tuple[str, ...]
    """(m,) m ≥ n; the i-th is crop i's."""
    true: Tensor
    """(n, m) whether a caption is true of a crop."""
    possible: Tensor
    """(n, m) whether it is or may be, for all that is known of the crop's colour or told of colours of its category."""


class CropBatches:
    """Draws batches: every category as often as any other, hidden things less often."""

    def __init__(
        self, patches: Patches, writer: CaptionWriter, preprocessing: Preprocessing, settings: MatcherSettings
    ) -> None:
        self._patches, self._writer, self._settings = patches, writer, settings
        self._mean = 255 * torch.tensor(preprocessing.mean)[:, None, None]
        self._std = 255 * torch.tensor(preprocessing.std)[:, None, None]
        self._things = np.flatnonzero(~patches.background & (patches.visible >= settings.least_visible))
        self._rest = np.flatnonzero(patches.background)
        if not len(self._things):
            raise InputError(f"training: no crop shows {settings.least_visible:.0%} of its thing (other data)")
        kinds = patches.categories[self._things]
        sight = patches.visible[self._things] / (2 * settings.least_visible)
        weights = np.minimum(sight, 1.0) / np.bincount(kinds)[kinds]
        self._cumulative = np.cumsum(weights) / weights.sum()
        pairs = _pairs(patches)
        self._paintable = np.isin((*patches.names, "", ""), [*many_coloured(pairs)])
        self._untold = _untold(patches, pairs)

    def draw(self, step: int, size: int) -> CropBatch:
        """Return the batch of a step, always the same one, with images of that side [px]."""
        settings = self._settings
        rng = np.random.default_rng([settings.seed, step])
        generator = torch.Generator().manual_seed(settings.seed * 1_000_003 + step)
        rows = self._rows(settings.batch, rng)
        captioned = np.concatenate([rows, self._rows(settings.more_captions, rng)])
        categories, colours = (np.asarray(x[captioned], dtype=np.intp) for x in self._labels)
        n = len(rows)
        repainted = self._paintable[categories[:n]] & (rng.random(n) < settings.augmentation.repainted)
        colours[:n][repainted] = NO_COLOUR
        captions = self._writer.write(categories, colours, rng)
        true = self._writer.true_of(categories[:n], colours[:n], captions)
        possible = true | (repainted[:, None] & self._writer.true_in_some_colour(categories[:n], captions))
        possible |= self._writer.untold_of(categories[:n], colours[:n], captions, self._untold)
        images = self._images(rows, torch.from_numpy(repainted), size, generator)
        labels = self._labels_of(categories[:n], colours[:n])
        return CropBatch(images, labels, captions.texts, torch.from_numpy(true), torch.from_numpy(possible))

    def _labels_of(self, categories: NDArray[np.intp], colours: NDArray[np.intp]) -> Labels:
        of_category = self._untold[categories]
        of_colour = self._untold.T[colours] & (colours != NO_COLOUR)[:, None]
        return Labels(*(torch.from_numpy(each) for each in (categories, colours, of_colour, of_category)))

    @property
    def _labels(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        return self._patches.categories, self._patches.colours

    def _rows(self, count: int, rng: np.random.Generator) -> NDArray[np.intp]:
        rest = round(count * self._settings.background) if len(self._rest) else 0
        drawn = np.searchsorted(self._cumulative, rng.random(count - rest)).clip(max=len(self._things) - 1)
        return np.concatenate([self._things[drawn], rng.choice(self._rest, rest) if rest else self._rest[:0]])

    def _images(self, rows: NDArray[np.intp], repainted: Tensor, size: int, rng: torch.Generator) -> Tensor:
        patches, how = self._patches, self._settings.augmentation
        boxes, limits = torch.from_numpy(patches.boxes[rows]), torch.from_numpy(patches.limits[rows])
        pixels = torch.from_numpy(patches.pixels[rows]).permute(0, 3, 1, 2).float()
        mirrored = torch.rand(len(rows), generator=rng) < 0.5
        squares, inside = cut_squares(pixels, boxes_near(boxes, limits, how, rng), mirrored, size)
        squares = vary_light(repaint(squares, repainted, rng), how, rng)
        squares = coarsen(squares, torch.from_numpy(patches.lengths[rows]), how, rng)
        return ((squares - self._mean) / self._std * inside).contiguous(memory_format=torch.channels_last)


def _pairs(patches: Patches) -> list[Pair]:
    """Return the pairs of colour and category that the patches show."""
    pairs = np.unique(np.stack([patches.colours, patches.categories]), axis=1).T.tolist()
    names = (*patches.names, "", "")
    return [(patches.colour_names[colour], names[category]) for colour, category in pairs if colour != NO_COLOUR]


def _untold(patches: Patches, pairs: list[Pair]) -> NDArray[np.bool_]:
    """Return whether the patches say nothing of a category (or of background) in a colour, (k + 2, c)."""
    table = np.zeros((len(patches.names) + 2, max(len(patches.colour_names), 1)), dtype=bool)
    for colour, category in untold_pairs(pairs):
        table[patches.names.index(category), patches.colour_names.index(colour)] = True
    return table
