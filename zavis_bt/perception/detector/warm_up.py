"""Before it detects, a small backbone learns to tell known things that are cut out.

A backbone from random weights meets a few labelled things in an image; cut out, it sees several times as many in the
same time. This stands in for the weights from ImageNet that large backbones begin with.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional as F

from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.detector.backbones import TinyBody
from zavis_bt.perception.detector.batches import lit

_SIDE, _LEAST_SIDE, _WIDTH = 64, 20.0, 320  # of cut-outs, of things in the full image, of the images that are cut [px]


@dataclass(frozen=True, slots=True)
class WarmUp:
    """How the backbone is prepared."""

    iterations: int = 2000
    batch: int = 64
    """Cut-outs an iteration."""
    learning_rate: float = 3e-3


def warm_up(
    body: TinyBody,
    normalise: Callable[[Tensor], Tensor],
    dataset: DetectionDataset,
    known: Sequence[str],
    settings: WarmUp,
    seed: int,
    progress: Callable[[int], None] = lambda done: None,
) -> float:
    """Teach a backbone to tell known things.

    Args:
        body: Changed.
        normalise: Of images from 0 to 1, as the detector does it.
        dataset: Images to cut things out of.
        known: The classes.
        settings: How long.
        seed: Of the order and the cuts.
        progress: Told how many iterations are done.

    Returns:
        Share of right answers in the last tenth, on what is learnt from.
    """
    labels = {name: number for number, name in enumerate(known)}
    things = [
        (index, np.array(thing.box), labels[thing.category])
        for index in range(len(dataset))
        for thing in dataset.annotations(index)
        if thing.category in labels and not thing.ignored and _side(thing.box) >= _LEAST_SIDE
    ]
    if not things:
        return math.nan
    rng = np.random.default_rng([seed, 2])
    device = next(body.parameters()).device
    answer = nn.Linear(body.features, len(known)).to(device)
    parameters = [*body.stem.parameters(), *body.stages.parameters(), *answer.parameters()]
    optimiser = torch.optim.AdamW(parameters, settings.learning_rate, weight_decay=0.05)
    right: list[float] = []
    for done in range(settings.iterations):
        for group in optimiser.param_groups:
            group["lr"] = settings.learning_rate * _rate(done, settings.iterations)
        chosen = [things[number] for number in rng.integers(len(things), size=settings.batch)]
        images = np.stack([_cut_out(dataset, index, box, rng) for index, box, _ in chosen])
        batch = normalise(torch.from_numpy(images).to(device).permute(0, 3, 1, 2).float() / 255)
        truth = torch.tensor([label for _, _, label in chosen], device=device)
        logits = answer(body.summary(batch.contiguous(memory_format=torch.channels_last)))
        F.cross_entropy(logits, truth, label_smoothing=0.05).backward()
        nn.utils.clip_grad_norm_(parameters, 5.0)
        optimiser.step()
        optimiser.zero_grad(set_to_none=True)
        right.append(float((logits.argmax(dim=1) == truth).float().mean()))
        progress(done + 1)
    return float(np.mean(right[-max(len(right) // 10, 1) :]))


def _rate(done: int, iterations: int) -> float:
    rise = min(50, max(iterations // 10, 1))
    return min((done + 1) / rise, 1.0) * (0.01 + 0.495 * (1 + math.cos(math.pi * done / iterations)))


def _side(box: Sequence[float]) -> float:
    return min(box[2] - box[0], box[3] - box[1])


def _cut_out(
    dataset: DetectionDataset, index: int, box: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.uint8]:
    """Return a square that holds a thing, or nearly, perhaps mirrored and somewhat stretched."""
    image = dataset.image(index, width=_WIDTH)
    box = box * image.shape[1] / dataset.size(index)[0]
    side = max(box[2] - box[0], box[3] - box[1]) * rng.uniform(1.0, 1.5)
    middle = (box[:2] + box[2:]) / 2 + rng.uniform(-0.12, 0.12, 2) * side
    stretch = rng.uniform(0.85, 1.18)
    half = np.array([side * stretch, side / stretch]) / 2
    low, high = np.floor(middle - half).astype(int), np.ceil(middle + half).astype(int) + 1
    inside = image[max(low[1], 0) : high[1], max(low[0], 0) : high[0]]
    beyond = np.maximum(high - image.shape[1::-1], 0)
    before = np.maximum(-low, 0)
    square = cv2.copyMakeBorder(inside, before[1], beyond[1], before[0], beyond[0], cv2.BORDER_REPLICATE)
    how = cv2.INTER_AREA if min(square.shape[:2]) > _SIDE else cv2.INTER_LINEAR
    out = np.asarray(cv2.resize(square, (_SIDE, _SIDE), interpolation=how), dtype=np.uint8)
    return lit(out[:, ::-1] if rng.random() < 0.5 else out, rng)
