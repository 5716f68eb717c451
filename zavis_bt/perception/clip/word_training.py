"""Fitting a word tower to a trained image tower."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from zavis_bt.perception.clip.augment import cut_squares
from zavis_bt.perception.clip.captions import CaptionWriter
from zavis_bt.perception.clip.crops import Preprocessing
from zavis_bt.perception.clip.loading import Parts
from zavis_bt.perception.clip.loss import contrastive_loss
from zavis_bt.perception.clip.patches import Patches
from zavis_bt.perception.clip.vocabulary import Vocabulary
from zavis_bt.perception.clip.word_tower import WordTower

_BATCH, _CROPS = 512, 30_000
_LEAST_VISIBLE = 0.4
_RATE, _DECAY = 2e-3, 0.2


def fit_word_tower(
    parts: Parts,
    patches: Patches,
    vocabulary: Vocabulary,
    *,
    steps: int = 1500,
    seed: int = 0,
    progress: Callable[[int], None] = lambda done: None,
) -> WordTower:
    """Return a word tower that puts captions where the image tower puts their crops.

    Args:
        parts: Model whose image tower is used; not changed.
        patches: Crops it was trained on.
        vocabulary: Words for the captions.
        steps: Of the optimiser.
        seed: Of all draws.
        progress: Told how many steps are behind.
    """
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    writer = CaptionWriter(patches.names, patches.colour_names, vocabulary)
    usable = np.flatnonzero(patches.background | (patches.visible >= _LEAST_VISIBLE))
    rows = rng.permutation(usable)[:_CROPS]
    vectors = _encode(parts, patches, np.sort(rows))
    categories, colours = (np.asarray(x[np.sort(rows)], dtype=np.intp) for x in (patches.categories, patches.colours))
    weights = 1 / np.sqrt(np.bincount(categories)[categories])
    tower = WordTower(parts.network, vectors.shape[1]).train()
    learnt = [*tower.image_projection.parameters(), *tower.text_projection.parameters(), tower.logit_scale]
    optimiser = torch.optim.AdamW(learnt, lr=_RATE, weight_decay=_DECAY)
    for step in range(steps):
        optimiser.param_groups[0]["lr"] = _RATE * (0.5 + 0.5 * math.cos(math.pi * step / steps)) + 1e-6
        drawn = rng.choice(len(vectors), _BATCH, p=weights / weights.sum())
        captions = writer.write(categories[drawn], colours[drawn], rng)
        true = torch.from_numpy(writer.true_of(categories[drawn], colours[drawn], captions))
        images = F.normalize(tower.project(vectors[drawn]), dim=-1)
        texts = F.normalize(tower.encode_text(tower.tokenise([*captions.texts])), dim=-1)
        loss = contrastive_loss(images, texts, true, true, tower.logit_scale.exp())
        optimiser.zero_grad(set_to_none=True)
        loss.backward()
        optimiser.step()
        progress(step + 1)
    return tower.eval()


@torch.inference_mode()
def _encode(parts: Parts, patches: Patches, rows: np.ndarray[tuple[int], np.dtype[np.intp]]) -> Tensor:
    """Return the image tower's vectors of patches, cut as they are labelled."""
    look: Preprocessing = parts.preprocessing
    mean, std = (255 * torch.tensor(x)[:, None, None] for x in (look.mean, look.std))
    visual = parts.network.eval().get_submodule("visual")
    found = []
    for start in range(0, len(rows), _BATCH):
        some = rows[start : start + _BATCH]
        pixels = torch.from_numpy(patches.pixels[some]).permute(0, 3, 1, 2).float()
        plain = torch.zeros(len(some), dtype=torch.bool)
        squares, inside = cut_squares(pixels, torch.from_numpy(patches.boxes[some]), plain, look.size)
        found.append(visual((squares - mean) / std * inside))
    return torch.cat(found).clone()
