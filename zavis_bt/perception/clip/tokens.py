"""Leaving out words that a model never learnt."""

from __future__ import annotations

from collections.abc import Callable

import torch
from torch import Tensor

Tokenizer = Callable[[list[str]], Tensor]


class KnownWords:
    """A tokenizer that skips tokens whose vectors are zero, as are those of words that no training caption had.

    To a model trained on few words "shiny red wallet" is then "red wallet"; a strange token in between would only
    move the others to places where it does not know them.
    """

    def __init__(self, tokenizer: Tokenizer, vectors: Tensor) -> None:
        """Wrap a tokenizer of a model with these token vectors (n, d)."""
        self._tokenizer = tokenizer
        self._known = (vectors != 0).any(dim=1)

    def __call__(self, texts: list[str]) -> Tensor:
        """Return tokens (n, length), the rest of each row zero."""
        tokens = self._tokenizer(texts)
        shortened = torch.zeros_like(tokens)
        for row, known in enumerate(self._known[tokens]):
            kept = tokens[row, known]
            shortened[row, : len(kept)] = kept
        return shortened
