"""Training a detector; it can be interrupted anywhere and goes on exactly."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import torch
from torch import Tensor

from zavis_bt.errors import InputError
from zavis_bt.perception.datasets import DetectionDataset
from zavis_bt.perception.detector.backbones import TinyBody
from zavis_bt.perception.detector.batches import Batches, Views
from zavis_bt.perception.detector.checkpoint import Checkpoint
from zavis_bt.perception.detector.collages import Collages
from zavis_bt.perception.detector.course import Course
from zavis_bt.perception.detector.fitting import fit
from zavis_bt.perception.detector.network import DetectorNetwork
from zavis_bt.perception.detector.proposals import Target
from zavis_bt.perception.detector.pseudo_labels import Labelling
from zavis_bt.perception.detector.training_log import TrainingLog
from zavis_bt.perception.detector.warm_up import WarmUp, warm_up

_FIT_BATCHES = 40  # of the training's, for the distributions that tell unknown things
_CLIP_NORM = 5.0
_WEIGHT_DECAY = 0.05

Batch = tuple[Tensor, list[Target], bool]


@dataclass(frozen=True, slots=True)
class TrainingSettings:
    """How a detector is trained."""

    iterations: int = 4000
    batch: int = 16
    """Images an iteration."""
    learning_rate: float = 2e-3
    """At its highest; it rises over a first part and falls along a cosine to a hundredth."""
    seed: int = 0
    """Of weights, order, views and samples."""
    workers: int = 0
    """Processes that read images."""
    save_every: int = 200
    """Iterations between checkpoints."""
    views: Views = field(default_factory=Views)
    collages_first: float = 0.0
    """Share of the iterations, at the start, that see collages of known things only."""
    collages: float = 0.0
    """Share of collages after that; without labels of unknown things, of which they show few."""
    warm_up: WarmUp | None = None
    """What a small backbone learns before; nothing if None."""


class Training:
    """A network, an optimiser and where they are in a training."""

    def __init__(
        self,
        network: DetectorNetwork,
        dataset: DetectionDataset,
        settings: TrainingSettings,
        labelling: Labelling | None = None,
        device: str = "cpu",
    ) -> None:
        check_data(dataset, network.config.known)
        self._dataset = dataset
        self.network = _on(network, device).train()
        self.settings, self._labelling, self._device = settings, labelling, device
        self.optimiser = _optimiser(self.network, settings.learning_rate)
        self.schedule = torch.optim.lr_scheduler.LambdaLR(self.optimiser, self._rate)
        self._scaler = torch.amp.GradScaler(device, enabled=device.startswith("cuda"))
        self.done = 0
        known, seed = network.config.known, settings.seed
        width, size, count = settings.views.width, settings.batch, settings.iterations
        self._views = Batches(dataset, known, views=settings.views, size=size, count=count, seed=seed)
        first, share = round(settings.collages_first * count), settings.collages
        collages = Collages(dataset, known, width=width, size=size, seed=seed) if first or share else None
        self._batches = Course(self._views, collages, first=first, share=share, seed=seed)

    def run(
        self,
        log: TrainingLog,
        save: Callable[[Checkpoint], None],
        progress: Callable[[int], None] = lambda done: None,
        warming_up: Callable[[int], None] = lambda done: None,
    ) -> None:
        """Train to the end and fit the distributions that tell unknown things.

        Args:
            log: Told the losses of each iteration.
            save: Told the state now and then, and at the end.
            progress: Told how many iterations are behind.
            warming_up: Told how many iterations of the warm-up are behind.

        Raises:
            InputError: The loss is no longer a number, or an image cannot be read.
        """
        if self.done == 0 and self.settings.warm_up is not None:
            self._warm_up(self.settings.warm_up, warming_up)
        for batch in self._remaining():
            losses = self._step(batch)
            self.done += 1
            log.write(self.done, losses, float(self.schedule.get_last_lr()[0]))
            progress(self.done)
            if self.done % self.settings.save_every == 0 and self.done < self.settings.iterations:
                save(self.state())
        count = min(_FIT_BATCHES, len(self._views))
        with _repeatable(self.settings.seed):
            batches = (self._moved((*self._views[k], False))[:2] for k in range(count))
            fit(self.network, batches, self._labelling)
        save(self.state())

    def _warm_up(self, settings: WarmUp, progress: Callable[[int], None]) -> None:
        if isinstance(self.network.body, TinyBody):
            with _repeatable(self.settings.seed, -1):
                warm_up(self.network, self._dataset, settings, self.settings.seed, progress)

    def state(self) -> Checkpoint:
        """Return all that is needed to go on."""
        return Checkpoint(
            self.network.config,
            self.done,
            self.settings.iterations,
            self.network.state_dict(),
            {
                "optimiser": self.optimiser.state_dict(),
                "schedule": self.schedule.state_dict(),
                "scaler": self._scaler.state_dict(),
            },
        )

    def resume(self, state: Checkpoint) -> None:
        """Go on from a state.

        Raises:
            InputError: It is another training's.
        """
        if state.config != self.network.config or state.iterations != self.settings.iterations:
            raise InputError(
                "--resume: the checkpoint is of another training (give the same --known, --method, --backbone and "
                f"--iterations {state.iterations}, or another --out)"
            )
        self.network.load_state_dict(state.weights)
        self.optimiser.load_state_dict(state.optimiser["optimiser"])
        self.schedule.load_state_dict(state.optimiser["schedule"])
        self._scaler.load_state_dict(state.optimiser["scaler"])
        self.done = state.done

    def _step(self, batch: Batch) -> dict[str, float]:
        images, targets, is_collage = self._moved(batch)
        labelling = None if is_collage else self._labelling
        progress = self.done / self.settings.iterations
        with _repeatable(self.settings.seed, self.done):
            losses = self.network.learn(images, targets, labelling, progress).losses
            total = torch.stack(list(losses.values())).sum()
        self._check(total)
        self.optimiser.zero_grad(set_to_none=True)
        self._scaler.scale(total).backward()
        self._scaler.unscale_(self.optimiser)
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), _CLIP_NORM)
        self._scaler.step(self.optimiser)
        self._scaler.update()
        self.schedule.step()
        return {name: loss.item() for name, loss in losses.items()} | {"total": total.item()}

    def _check(self, loss: Tensor) -> None:
        if not torch.isfinite(loss):
            raise InputError(
                f"training: the loss is {loss.item()} at iteration {self.done + 1} "
                f"(lower --learning-rate, now {self.settings.learning_rate:g}, and --resume from the last checkpoint)"
            )

    def _remaining(self) -> Iterable[Batch]:
        numbers = range(self.done, self.settings.iterations)
        if self.settings.workers == 0:
            return (self._batches[number] for number in numbers)
        return torch.utils.data.DataLoader(
            torch.utils.data.Subset(self._batches, list(numbers)),
            batch_size=None,
            num_workers=self.settings.workers,
            multiprocessing_context="spawn",
        )

    def _moved(self, batch: Batch) -> Batch:
        images, targets, is_collage = batch
        here = images.to(self._device).contiguous(memory_format=torch.channels_last)
        return here, [target.to(self._device) for target in targets], is_collage

    def _rate(self, done: int) -> float:
        rise = min(100, max(self.settings.iterations // 10, 1))
        return min((done + 1) / rise, 1.0) * (0.01 + 0.495 * (1 + math.cos(math.pi * done / self.settings.iterations)))


def check_data(dataset: DetectionDataset, known: tuple[str, ...]) -> None:
    """Refuse data that a detector of these classes cannot learn from.

    Raises:
        InputError: It is empty, or shows none of a known class.
    """
    if not len(dataset):
        raise InputError(f"{dataset.name}: holds no images (name a data set with some)")
    missing = set(known) - set(dataset.categories)
    if missing:
        raise InputError(
            f"--known: {dataset.name} has no {', '.join(sorted(missing))} (its categories: "
            f"{', '.join(sorted(dataset.categories)[:30])}{', …' if len(dataset.categories) > 30 else ''})"
        )
    shown = {thing.category for k in range(len(dataset)) for thing in dataset.annotations(k) if not thing.ignored}
    if not shown & set(known):
        raise InputError(f"{dataset.name}: no image shows a known class ({', '.join(known)}; name others with --known)")


def _on(network: DetectorNetwork, device: str) -> DetectorNetwork:
    network.to(device)
    for each in network.parameters():
        if each.ndim == 4:
            each.data = each.data.contiguous(memory_format=torch.channels_last)
    return network


def _optimiser(network: DetectorNetwork, rate: float) -> torch.optim.Optimizer:
    parameters = [each for each in network.parameters() if each.requires_grad]
    groups: list[dict[str, Any]] = [
        {"params": [each for each in parameters if each.ndim > 1], "weight_decay": _WEIGHT_DECAY},
        {"params": [each for each in parameters if each.ndim <= 1], "weight_decay": 0.0},
    ]
    return torch.optim.AdamW(groups, rate)


@contextmanager
def _repeatable(*seed: int) -> Iterator[None]:
    """Let what torch draws here follow from the numbers alone, and nothing else from what is drawn here."""
    with torch.random.fork_rng():
        torch.manual_seed(sum(number * 1_000_003**k for k, number in enumerate(seed, start=1)) % 2**63)
        yield
