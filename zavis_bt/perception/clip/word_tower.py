"""A text tower of frozen word vectors, for words that no training caption had."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from safetensors.torch import load_file, save_file
from torch import Tensor, nn

from zavis_bt.knowledge.vectors import word_vectors

WORDS = "word_tower.safetensors"
"""The file of a word tower, beside the model whose image tower it uses."""

_PROMPT = "a photo of "
_SCALE = 20.0  # of the cosines, at the start


class WordTower(nn.Module):
    """Locked-image text tuning turned about: image tower and word vectors stay, two projections between are learnt.

    Zhai et al., "LiT: Zero-Shot Transfer with Locked-image text Tuning" (2022), lock a strong tower and tune the
    other to it. Here what is strong is the text side: static vectors of all English words, which put "couch" beside
    "sofa" although no caption of the training said it.
    """

    def __init__(self, clip: nn.Module, dimension: int, width: int = 128) -> None:
        """Put projections on an image tower whose vectors have length ``dimension``."""
        super().__init__()
        self.visual = clip.get_submodule("visual")
        vocabulary = word_vectors().embed(["thing"]).shape[1]
        self.image_projection = nn.Linear(dimension, width)
        self.text_projection = nn.Linear(vocabulary, width)
        self.logit_scale = nn.Parameter(torch.tensor(math.log(_SCALE)))

    @classmethod
    def load(cls, clip: nn.Module, path: Path) -> WordTower:
        """Return the tower of a file on the image tower of a model."""
        weights = {name: value.float() for name, value in load_file(path).items()}
        width, dimension = weights["image_projection.weight"].shape
        tower = cls(clip, dimension, width)
        tower.load_state_dict(weights | {f"visual.{name}": value for name, value in tower.visual.state_dict().items()})
        return tower

    def save(self, path: Path) -> None:
        """Write the projections; the image tower is the model's."""
        own = {name: value for name, value in self.state_dict().items() if not name.startswith("visual.")}
        save_file({name: value.contiguous().cpu() for name, value in own.items()}, path)
        path.chmod(0o644)  # like any other file

    @staticmethod
    def tokenise(texts: list[str]) -> Tensor:
        """Return the frozen vectors (n, 256) of texts, without the prompt's words."""
        vectors = word_vectors().embed([text.removeprefix(_PROMPT) for text in texts])
        return torch.from_numpy(vectors.astype(np.float32))

    def encode_image(self, images: Tensor) -> Tensor:
        """Return vectors (n, d) of images as the image tower reads them."""
        return self.project(self.visual(images))

    def project(self, vectors: Tensor) -> Tensor:
        """Return vectors (n, d) of the image tower's (n, d')."""
        projected: Tensor = self.image_projection(F.normalize(vectors, dim=-1))
        return projected

    def encode_text(self, vectors: Tensor) -> Tensor:
        """Return vectors (n, d) of texts as `tokenise` gives them."""
        projected: Tensor = self.text_projection(vectors)
        return projected
