"""Where a target usually is, from the commonsense transformer COMET-BART (ATOMIC 2020)."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.knowledge.text import normalise
from zavis_bt.knowledge.vectors import WordVectors, word_vectors
from zavis_bt.protocols import KnowledgePrior
from zavis_bt.types import FloatArray

MODEL = "comet"
"""Name of the model in ``zavis models list``."""
_LIBRARIES = ("torch", "transformers")
_LONGEST = 24  # tokens of a generated place
_NOTHING = "none"  # what ATOMIC's annotators wrote where nothing follows


def comet(model: Path | str = MODEL, *, device: str = "cpu", beams: int = 20, generations: int = 20) -> KnowledgePrior:
    """Make the paper's prior; see `CometPrior`.

    Args:
        model: Folder with a BART as transformers saves it, or the name of an added model.
        device: Where it computes, e.g. ``cpu`` or ``cuda:0``.
        beams: Width of the beam search.
        generations: Places to generate for each target, at most as many as beams.

    Raises:
        InputError: A setting is wrong, torch or transformers are not installed, or the model is not here or no BART.
    """
    if not 1 <= generations <= beams:
        raise InputError(f"prior 'comet': generations is {generations} (1 to {beams}, the number of beams)")
    missing = [library for library in _LIBRARIES if find_spec(library) is None]
    if missing:
        raise InputError(f"prior 'comet': needs {missing[0]} (pip install 'zavis_bt[neural]')")
    from zavis_bt.perception.models import find_weights

    generator = CometGenerator(find_weights(model), device=device, beams=beams, generations=generations)
    return CometPrior(generator.places, word_vectors())


class CometPrior:
    """The knowledge prior p(target | landmark) from generated places (Eq. co_occurrence).

    p = max_i ℓ(place_i, landmark) over the places that COMET generates for the target, ℓ the cosine of word vectors,
    clipped to [0, 1]. The paper's equation prints the target in the landmark's stead; this follows its text. Where
    nothing is generated, nothing is known: then p = 1 everywhere, and no landmark is skipped.

    Args:
        places: Gives the places of a target; asked once for each.
        vectors: Word vectors.
    """

    def __init__(self, places: Callable[[str], Sequence[str]], vectors: WordVectors) -> None:
        self._places = lru_cache(maxsize=512)(places)
        self._vectors = vectors
        self._lock = threading.Lock()  # or two jobs would generate the same at once

    def probability(self, target: str, landmarks: Sequence[str]) -> FloatArray:
        """Return p(target | landmark) in [0, 1], shape (n_landmarks,)."""
        if not landmarks:
            return np.zeros(0)
        with self._lock:
            places = self._places(normalise(target))
        if not places:
            return np.ones(len(landmarks))
        likeness: FloatArray = self._vectors.similarities(places, landmarks).max(axis=0)
        return np.clip(likeness, 0.0, 1.0)


class CometGenerator:
    """Completes "a {target} AtLocation [GEN]" by beam search.

    Args:
        folder: A BART and its tokenizer as transformers saves them; nothing is downloaded.
        device: Where it computes.
        beams: Width of the beam search.
        generations: Completions to keep, the likeliest first.

    Raises:
        InputError: The folder holds no such model, or there is no such device.
    """

    def __init__(self, folder: Path, *, device: str = "cpu", beams: int = 20, generations: int = 20) -> None:
        self._device, self._beams, self._generations = device, beams, generations
        self._model, self._tokenizer = _load(folder, device)

    def places(self, target: str) -> tuple[str, ...]:
        """Return the generated places, the likeliest first, each once; at most as many as were asked for."""
        import torch

        query = f"a {target.lower()} AtLocation [GEN]"  # the relation is one token, written as it was trained
        most = self._model.config.max_position_embeddings
        batch = self._tokenizer(query, return_tensors="pt", truncation=True, max_length=most).to(self._device)
        with torch.inference_mode():
            completions = self._model.generate(
                input_ids=batch["input_ids"],
                attention_mask=batch["attention_mask"],
                do_sample=False,
                num_beams=self._beams,
                num_return_sequences=self._generations,
                max_length=_LONGEST,
                min_length=0,
                length_penalty=1.0,
            )
        texts = self._tokenizer.batch_decode(completions, skip_special_tokens=True)
        found = dict.fromkeys(normalise(text) for text in texts)
        return tuple(place for place in found if place and place != _NOTHING)


def _load(folder: Path, device: str) -> tuple[Any, Any]:  # transformers' own types fit neither BART nor beam search
    import torch
    from transformers import AutoTokenizer, BartForConditionalGeneration

    tokenizer: Any
    loaded: Any
    try:
        with _no_bars():
            tokenizer = AutoTokenizer.from_pretrained(folder, local_files_only=True)
            loaded = BartForConditionalGeneration.from_pretrained(
                folder, local_files_only=True, output_loading_info=True
            )
    except Exception as error:  # tokenizers raises Exception itself for a broken file, the others whatever they meet
        raise InputError(
            f"{folder}: cannot be loaded as COMET-BART: {_first_line(error)} (zavis models check)"
        ) from error
    model, report = loaded
    wrong = len(report["missing_keys"]) + len(report["mismatched_keys"])
    if wrong:
        raise InputError(f"{folder}: {wrong} weights of its BART are missing or of another size (add the model again)")
    try:
        return model.eval().to(torch.device(device)), tokenizer
    except (RuntimeError, AssertionError) as error:  # the latter from a torch without CUDA
        raise InputError(f"prior 'comet': device '{device}': {_first_line(error)} (choose cpu)") from error


@contextmanager
def _no_bars() -> Iterator[None]:
    """Keep transformers from drawing bars into everybody's terminal."""
    from transformers.utils import logging

    shown = logging.is_progress_bar_enabled()
    logging.disable_progress_bar()
    try:
        yield
    finally:
        if shown:
            logging.enable_progress_bar()


def _first_line(error: BaseException) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0][:160]
