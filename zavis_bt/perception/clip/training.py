"""Training a matcher; it can be interrupted anywhere and goes on exactly."""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any, Protocol

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from zavis_bt.errors import InputError
from zavis_bt.perception.clip.batches import CropBatch, CropBatches
from zavis_bt.perception.clip.captions import CaptionWriter
from zavis_bt.perception.clip.half_size import can_halve, reading_half_size
from zavis_bt.perception.clip.heads import LabelHeads, label_loss, untold_colour_loss
from zavis_bt.perception.clip.loading import Parts
from zavis_bt.perception.clip.loss import contrastive_loss
from zavis_bt.perception.clip.patches import Patches
from zavis_bt.perception.clip.settings import MatcherSettings
from zavis_bt.perception.clip.towers import encode_image, encode_text
from zavis_bt.perception.clip.vocabulary import Vocabulary
from zavis_bt.perception.training.kept_state import KeptState
from zavis_bt.perception.training.precision import mixed_precision

KEPT = KeptState("zavis-matcher-training/1", "zavis matcher train")
_MOST_SCALE = math.log(100)  # of the cosines, as in CLIP
_HEADS = 0.5  # weight of the classifiers beside the text tower, falling to nothing
_UNTOLD = 0.1  # weight of what excludes untold colours too firmly
_RISE = 60  # steps over which the learning rate rises


class Log(Protocol):
    """Takes the figures of each step."""

    def write(self, iteration: int, losses: dict[str, float], rate: float) -> None:
        """Take a step's figures."""


class MatcherTraining:
    """A network, an optimiser and where they are in a training.

    The loss is InfoNCE between crops and captions, plus the cross entropy of every category's and colour's name as
    the text tower puts them, plus, less and less, that of two linear classifiers.
    """

    def __init__(
        self, parts: Parts, patches: Patches, vocabulary: Vocabulary, settings: MatcherSettings, device: str = "cpu"
    ) -> None:
        torch.manual_seed(settings.seed)
        writer = CaptionWriter(patches.names, patches.colour_names, vocabulary)
        self.settings, self._device, self._parts = settings, device, parts
        self.network = parts.network.to(device).train()
        self._visual = self.network.get_submodule("visual")
        self._visual.to(memory_format=torch.channels_last)
        self._size = parts.preprocessing.size
        self._batches = CropBatches(patches, writer, parts.preprocessing, settings)
        self._names = [f"a photo of {name}" for name in (*patches.names, "background", "part of something")]
        self._colours = [f"a photo of {colour} thing" for colour in patches.colour_names or ("no",)]
        if settings.from_scratch:
            self._silence_other_words(writer)
        self._heads = LabelHeads(self._dimension(), len(self._names), len(patches.colour_names)).to(device)
        self.optimiser = _optimiser(self.network, self._heads, settings)
        self._rates = [group["lr"] for group in self.optimiser.param_groups]
        self._scaler = torch.amp.GradScaler(device, enabled=device.startswith("cuda"))
        self._average = copy.deepcopy(self.network.state_dict())
        self.done = 0

    def run(
        self,
        log: Log,
        save: Callable[[dict[str, Any]], None],
        progress: Callable[[int], None] = lambda done: None,
        seconds: float = math.inf,
    ) -> None:
        """Train to the end.

        Args:
            log: Told the figures of each step.
            save: Told the state now and then, and at the end.
            progress: Told how many steps are behind.
            seconds: Time to stop after, as if there were no more steps: the learning rate falls with the time spent.

        Raises:
            InputError: The loss is no longer a number.
        """
        start, before = time.monotonic(), self.done / self.settings.steps
        while self.done < self.settings.steps:
            spent = before + (1 - before) * (time.monotonic() - start) / seconds
            if spent >= 1:
                break
            share = max(self.done / self.settings.steps, spent)
            rate = self._set_rate(share)
            figures = self._step(share)
            self.done += 1
            log.write(self.done, figures, rate)
            progress(self.done)
            if self.done % self.settings.save_every == 0:
                save(self.state())
        save(self.state())

    def state(self) -> dict[str, Any]:
        """Return all that is needed to go on."""
        return {
            "done": self.done,
            "network": self.network.state_dict(),
            "average": self._average,
            "heads": self._heads.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "scaler": self._scaler.state_dict(),
        }

    def resume(self, state: dict[str, Any]) -> None:
        """Go on from a state.

        Raises:
            InputError: It is another training's.
        """
        try:
            self.network.load_state_dict(state["network"])
            self._heads.load_state_dict(state["heads"])
            self.optimiser.load_state_dict(state["optimiser"])
            self._scaler.load_state_dict(state["scaler"])
        except (RuntimeError, ValueError, KeyError) as error:
            raise InputError("--resume: the checkpoint is of another training (same DATA and --model)") from error
        self._average, self.done = state["average"], int(state["done"])

    def averaged_weights(self) -> dict[str, Tensor]:
        """Return the weights to use: a running average over the last steps."""
        return self._average

    @torch.no_grad()
    def _silence_other_words(self, writer: CaptionWriter) -> None:
        """Set the vectors of words that captions never have to zero: they say nothing, and pack well."""
        embedding = self.network.get_submodule("token_embedding").get_parameter("weight")
        used = self._parts.tokenizer([*writer.words(), *self._names, *self._colours]).unique()
        kept = embedding[used.to(self._device)].clone()
        embedding.zero_()[used.to(self._device)] = kept

    def _step(self, share: float) -> dict[str, float]:
        half = share < self.settings.half_size and can_halve(self._visual, self._size)
        batch = self._batches.draw(self.done, self._size // 2 if half else self._size)
        with reading_half_size(self._visual, self._size) if half else nullcontext():
            loss, figures = self._loss(batch, share)
        if not torch.isfinite(loss):
            raise InputError(
                f"training: the loss is {loss.item()} at step {self.done + 1} "
                f"(lower --learning-rate, now {self.settings.learning_rate:g}, and --resume from the last checkpoint)"
            )
        self.optimiser.zero_grad(set_to_none=True)
        self._scaler.scale(loss).backward()
        self._scaler.unscale_(self.optimiser)
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        self._scaler.step(self.optimiser)
        self._scaler.update()
        self._update_average()
        return figures

    def _loss(self, batch: CropBatch, share: float) -> tuple[Tensor, dict[str, float]]:
        with mixed_precision(self._device):
            vectors = encode_image(self.network, batch.images.to(self._device)).float()
        images = F.normalize(vectors, dim=-1)
        texts = dict.fromkeys((*self._names, *self._colours, *batch.texts))
        rows = {text: row for row, text in enumerate(texts)}
        tokens = self._parts.tokenizer([*texts]).to(self._device)
        encoded = F.normalize(encode_text(self.network, tokens), dim=-1)
        names, colours, captions = (
            encoded[[rows[text] for text in some]] for some in (self._names, self._colours, batch.texts)
        )
        scale = self.network.get_parameter("logit_scale").exp()
        labels = batch.labels.to(self._device)
        true, possible = batch.true.to(self._device), batch.possible.to(self._device)
        contrast = contrastive_loss(images, captions, true, possible, scale)
        of_colour = scale * images @ colours.T
        naming = label_loss(scale * images @ names.T, of_colour, labels)
        naming = naming + _UNTOLD * untold_colour_loss(of_colour, labels)
        heads = self._heads.loss(vectors, labels)
        right = (images @ names.T).argmax(dim=1) == labels.categories
        figures = {"contrast": contrast, "naming": naming, "accuracy": right.float().mean(), "scale": scale}
        loss = contrast + naming + _HEADS * (1 - share) * heads
        return loss, {name: float(value.detach()) for name, value in figures.items()}

    @torch.no_grad()
    def _update_average(self) -> None:
        self.network.get_parameter("logit_scale").clamp_(0, _MOST_SCALE)
        kept = min(self.settings.averaging, (self.done + 1) / (self.done + 10))
        for name, value in self.network.state_dict().items():
            if value.dtype.is_floating_point:
                self._average[name].lerp_(value, 1 - kept)
            else:
                self._average[name].copy_(value)

    def _set_rate(self, share: float) -> float:
        factor = min((self.done + 1) / _RISE, 1.0) * (0.5 + 0.5 * math.cos(math.pi * share)) + 1e-4
        for group, rate in zip(self.optimiser.param_groups, self._rates, strict=True):
            group["lr"] = rate * factor
        return self.settings.learning_rate * factor

    @torch.no_grad()
    def _dimension(self) -> int:
        tokens = self._parts.tokenizer(["thing"]).to(self._device)
        return encode_text(self.network, tokens).shape[1]


def _optimiser(network: nn.Module, heads: nn.Module, settings: MatcherSettings) -> torch.optim.AdamW:
    """Decay the weights of products only; norms, biases, embeddings and the scale stay free."""
    decaying: list[Tensor] = []
    free: list[Tensor] = []
    for name, parameter in network.named_parameters():
        if name != "logit_scale":
            (decaying if parameter.ndim > 1 and "embedding" not in name else free).append(parameter)
    rate = settings.learning_rate
    groups: list[dict[str, Any]] = [
        {"params": [*decaying, *heads.parameters()], "weight_decay": settings.weight_decay, "lr": rate},
        {"params": free, "weight_decay": 0.0, "lr": rate},
        {"params": [network.get_parameter("logit_scale")], "weight_decay": 0.0, "lr": 3 * rate},
    ]
    return torch.optim.AdamW(groups, betas=(0.9, 0.98))
