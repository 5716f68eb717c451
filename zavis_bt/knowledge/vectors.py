"""Static word vectors."""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from zavis_bt.errors import ZavisError
from zavis_bt.knowledge.text import normalise
from zavis_bt.types import FloatArray

if TYPE_CHECKING:
    from tokenizers import Tokenizer

_PACKAGE = "wordllama"
_WEIGHTS = "weights/l2_supercat_256.safetensors"
_TOKENIZER = "tokenizers/l2_supercat_tokenizer_config.json"
_WORD_START = "▁"  # what the tokenizer writes for the space before a word


@lru_cache(maxsize=1)
def word_vectors() -> WordVectors:
    """Return the vectors that everybody in this process shares: reading their files takes a tenth of a second."""
    return WordVectors()


class WordVectors:
    """Word vectors w(·) of the paper's co-occurrence measure: the static ones that ship inside wordllama's wheel.

    A text's vector is the mean of its tokens' vectors, brought to unit length. The files are read at first use
    (about 0.1 s) straight from the installed package: nothing is downloaded, and importing wordllama itself, which
    sets up logging for the whole process, is avoided. Instances may be shared between threads.
    """

    def __init__(self) -> None:
        self._embed = lru_cache(maxsize=8192)(self._embed_normalised)

    def similarity(self, a: str, b: str) -> float:
        """Return the cosine of the two texts' vectors, in [-1, 1]; 0 if either text holds no word."""
        return float(self.similarities([a], [b])[0, 0])

    def similarities(self, a: Sequence[str], b: Sequence[str]) -> FloatArray:
        """Return the cosines (n, m) in [-1, 1] of n texts with m texts; 0 where either text holds no word."""
        return np.clip(self.embed(a) @ self.embed(b).T, -1.0, 1.0)

    def embed(self, texts: Sequence[str]) -> FloatArray:
        """Return the vectors (n, 256) of n texts: unit length, or zero for a text without words."""
        if not texts:
            return np.zeros((0, self._weights.shape[1]))
        return np.stack([self._embed(normalise(text)) for text in texts])

    def coverage(self, text: str) -> float:
        """Return the share of the text's words that the vocabulary holds whole, 0 to 1.

        The tokenizer splits other words into pieces that mean nothing by themselves: ``onion`` is ``on`` + ``ion``,
        and as near to ``lotion`` as to anything edible.
        """
        tokens = self._tokenizer.encode(normalise(text), add_special_tokens=False).tokens
        starts = [index for index, token in enumerate(tokens) if token.startswith(_WORD_START)]
        lengths = np.diff([*starts, len(tokens)])
        return float((lengths == 1).mean()) if starts else 0.0

    def _embed_normalised(self, text: str) -> FloatArray:
        ids = self._tokenizer.encode(text, add_special_tokens=False).ids if text else []
        if not ids:
            return np.zeros(self._weights.shape[1])
        mean = self._weights[ids].astype(np.float64).mean(axis=0)
        length = math.sqrt(float(mean @ mean))
        vector: FloatArray = mean / length if length > 0 else mean
        vector.setflags(write=False)
        return vector

    @cached_property
    def _weights(self) -> NDArray[np.float16]:
        from safetensors.numpy import load_file

        weights: NDArray[np.float16] = load_file(_find(_WEIGHTS))["embedding.weight"]
        return weights

    @cached_property
    def _tokenizer(self) -> Tokenizer:
        from tokenizers import Tokenizer

        tokenizer = Tokenizer.from_file(str(_find(_TOKENIZER)))
        tokenizer.no_padding()
        tokenizer.no_truncation()
        return tokenizer


def _find(name: str) -> Path:
    spec = importlib.util.find_spec(_PACKAGE)
    path = Path(spec.origin).parent / name if spec and spec.origin else None
    if path is None or not path.is_file():
        raise ZavisError(f"{_PACKAGE}: its word vectors '{name}' are missing (install wordllama 0.3.9 or newer again)")
    return path
