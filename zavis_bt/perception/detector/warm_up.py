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
from torchvision.ops import clip_boxes_to_image

from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.detector.backbones import TinyBody
from zavis_bt.perception.detector.batches import Batches, Views, lit
from zavis_bt.perception.detector.network import DetectorNetwork
from zavis_bt.perception.training.precision import mixed_precision

_SAMPLES = 96  # boxes of a view of many things
_SIDE, _LEAST_SIDE, _WIDTH = 64, 20.0, 320  # of cut-outs, of things in the full image, of the images that are cut [px]


@dataclass(frozen=True, slots=True)
class WarmUp:
    """How the backbone is prepared."""

    iterations: int = 3000
    """With cut-outs, backbone alone."""
    box_iterations: int = 9000
    """With boxes in views of many known things, backbone and box head."""
    batch: int = 128
    """Cut-outs an iteration."""
    box_batch: int = 8
    """Views an iteration."""
    learning_rate: float = 3e-3
    box_learning_rate: float = 2e-3


def warm_up(
    network: DetectorNetwork,
    dataset: DetectionDataset,
    settings: WarmUp,
    seed: int,
    progress: Callable[[int], None] = lambda done: None,
) -> None:
    """Teach a network with a small backbone to tell known things: cut out, then by their boxes.

    Args:
        network: Changed.
        dataset: Images with known things.
        settings: How long.
        seed: Of all draws.
        progress: Told how many iterations of both kinds are done.
    """
    assert isinstance(network.body, TinyBody)
    known = network.config.known
    warm_up_body(network.body, network.normalised, dataset, known, settings, seed, progress)
    views = Views(mosaic=1.0, grids=(1, 2, 3, 4), large=0.3)
    size, count = settings.box_batch, settings.box_iterations
    batches = Batches(dataset, known, views=views, size=size, count=count, seed=seed + 100)
    warm_up_boxes(
        network, batches, settings.box_learning_rate, seed, lambda done, _: progress(settings.iterations + done)
    )


def warm_up_body(
    body: TinyBody,
    normalise: Callable[[Tensor], Tensor],
    dataset: DetectionDataset,
    known: Sequence[str],
    settings: WarmUp,
    seed: int,
    progress: Callable[[int], None] = lambda done: None,
) -> float:
    """Teach a backbone to tell known things that are cut out.

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
        with mixed_precision(device.type):
            read = body.summary(batch.contiguous(memory_format=torch.channels_last))
        logits = answer(read.float())
        F.cross_entropy(logits, truth, label_smoothing=0.05).backward()
        nn.utils.clip_grad_norm_(parameters, 5.0)
        optimiser.step()
        optimiser.zero_grad(set_to_none=True)
        right.append(float((logits.argmax(dim=1) == truth).float().mean()))
        progress(done + 1)
    return float(np.mean(right[-max(len(right) // 10, 1) :]))


def warm_up_boxes(
    network: DetectorNetwork,
    batches: Batches,
    rate: float,
    seed: int,
    progress: Callable[[int, float], None] = lambda done, loss: None,
) -> None:
    """Teach backbone and box head on boxes around known things, without proposals.

    Args:
        network: Its proposal network is not changed.
        batches: Views of many known things.
        rate: Learning rate at its highest.
        seed: Of the boxes.
        progress: Told how many batches are done, and the loss.
    """
    parameters = [*network.body.parameters(), *network.rois.parameters()]
    optimiser = torch.optim.AdamW(parameters, rate, weight_decay=0.03)
    samples, network.rois.samples = network.rois.samples, _SAMPLES
    device = next(network.parameters()).device
    network.train()
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        for done in range(len(batches)):
            for group in optimiser.param_groups:
                group["lr"] = rate * _rate(done, len(batches))
            images, targets = batches[done]
            images, targets = images.to(device), [each.to(device) for each in targets]
            features, sizes = network.features(images.contiguous(memory_format=torch.channels_last))
            near = [clip_boxes_to_image(_jittered(each.boxes), sizes[0]) for each in targets]
            if not any(map(len, near)):
                continue
            loss = torch.stack(list(network.rois.learn(features, near, targets, sizes).losses.values())).sum()
            loss.backward()
            nn.utils.clip_grad_norm_(parameters, 5.0)
            optimiser.step()
            optimiser.zero_grad(set_to_none=True)
            progress(done + 1, loss.item())
    network.rois.samples = samples


def _jittered(boxes: Tensor, copies: int = 6, most: float = 0.3) -> Tensor:
    """Return copies of boxes with each edge moved by up to a share of the box's side."""
    many = boxes.repeat(copies, 1)
    sides = (many[:, 2:] - many[:, :2]).repeat(1, 2)
    moved = many + (torch.rand_like(many) * 2 - 1) * most * sides
    return moved[((moved[:, 2:] - moved[:, :2]) > 1).all(dim=1)]


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
