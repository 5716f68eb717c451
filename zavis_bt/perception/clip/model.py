"""A CLIP model: crops and texts to vectors of one space."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from torch import Tensor

from zavis_bt.errors import InputError
from zavis_bt.perception.clip.crops import Preprocessing
from zavis_bt.perception.clip.folding import fold_batch_norms
from zavis_bt.perception.clip.loading import Parts, build_untrained, load_parts, logit_scale
from zavis_bt.perception.clip.prompts import photo_of
from zavis_bt.perception.clip.towers import encode_image, encode_text

_BATCH = 64  # crops or texts at a time: ViT-B/32 stays far below 2 GB
_CACHED = 4096  # texts whose vectors are kept


class ClipModel:
    """Image and text tower of an open_clip model, ready to compare crops with names.

    Instances may be shared between threads.
    """

    def __init__(self, parts: Parts, device: str = "cpu") -> None:
        """Take over a network for inference: it can no longer be trained."""
        self.preprocessing: Preprocessing = parts.preprocessing
        self.logit_scale = logit_scale(parts.network)
        """Factor of the cosines that makes them logits; 100 for CLIP's own weights."""
        self._tokenizer = parts.tokenizer
        self._network = parts.network.eval()
        fold_batch_norms(self._network.get_submodule("visual"))
        self._device = torch.device(device)
        self._network.to(self._device).to(memory_format=torch.channels_last)
        self._vectors: dict[str, Tensor] = {}

    @classmethod
    def load(cls, model: str, pretrained: str | None = None, *, device: str = "cpu") -> ClipModel:
        """Return a model with its weights.

        Args:
            model: ``zavis-tiny``, the model shipped here; or a name of open_clip such as ``ViT-B-32``; or a folder
                with ``open_clip_config.json`` and weights.
            pretrained: For open_clip's models: tag of published weights, or a file of weights.
            device: As torch names it.

        Raises:
            InputError: There is no such model, or its weights cannot be had or do not fit.
        """
        return cls(load_parts(model, pretrained), device)

    @classmethod
    def untrained(cls, model: str, *, device: str = "cpu") -> ClipModel:
        """Return a model of open_clip with random weights, for measuring speed and memory."""
        return cls(build_untrained(model), device)

    @property
    def dimension(self) -> int:
        """Length d of the vectors."""
        return int(self.encode_texts(["thing"]).shape[1])

    def encode_images(self, crops: Sequence[NDArray[np.uint8]]) -> Tensor:
        """Return the vectors (n, d) of crops (h, w, 3) of any size, unit length.

        Raises:
            InputError: A crop has no pixel, or is no colour image.
        """
        for crop in crops:
            if crop.ndim != 3 or crop.shape[2] != 3 or 0 in crop.shape:
                raise InputError(f"CLIP: a crop of shape {crop.shape} (height, width and 3 colours, none of them 0)")
        if not crops:
            return torch.zeros((0, self.dimension), device=self._device)
        batches = [crops[start : start + _BATCH] for start in range(0, len(crops), _BATCH)]
        return torch.cat([self._encode_batch(batch) for batch in batches])

    def encode_texts(self, texts: Sequence[str]) -> Tensor:
        """Return the vectors (n, d) of texts, put as the paper's prompt "a photo of …", unit length.

        Raises:
            InputError: There is no text.
        """
        if not texts:
            raise InputError("CLIP: no text to compare with (at least one)")
        prompts = [photo_of(text) for text in texts]
        known = self._vectors
        new = [prompt for prompt in dict.fromkeys(prompts) if prompt not in known]
        fresh: dict[str, Tensor] = {}
        for start in range(0, len(new), _BATCH):
            batch = new[start : start + _BATCH]
            fresh.update(zip(batch, self._encode_prompts(batch), strict=True))
        vectors = torch.stack([fresh[prompt] if prompt in fresh else known[prompt] for prompt in prompts])
        # A new dictionary each time: other threads go on reading the one they hold.
        self._vectors = {**known, **fresh} if len(known) + len(fresh) <= _CACHED else fresh
        return vectors

    def scores(self, crops: Sequence[NDArray[np.uint8]], texts: Sequence[str]) -> NDArray[np.float32]:
        """Return the matching scores m (n, m) of crops with texts, 100 × cosine."""
        if not crops or not texts:
            return np.zeros((len(crops), len(texts)), dtype=np.float32)
        cosines = self.encode_images(crops) @ self.encode_texts(texts).T
        scores: NDArray[np.float32] = (100 * cosines).float().cpu().numpy()
        return scores

    @torch.inference_mode()
    def _encode_batch(self, crops: Sequence[NDArray[np.uint8]]) -> Tensor:
        images = self.preprocessing.apply(crops).to(self._device)
        images = images.contiguous(memory_format=torch.channels_last)
        return F.normalize(encode_image(self._network, images), dim=-1)

    @torch.inference_mode()
    def _encode_prompts(self, prompts: list[str]) -> Tensor:
        tokens = self._tokenizer(prompts).to(self._device)
        return F.normalize(encode_text(self._network, tokens), dim=-1)
