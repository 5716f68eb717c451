"""Building open_clip models from names, tags, paths and folders; what cannot be loaded is said in one line."""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import open_clip
from open_clip.factory import get_model_config, load_checkpoint
from torch import nn

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.perception.clip.crops import Preprocessing
from zavis_bt.perception.clip.tokens import KnownWords, Tokenizer
from zavis_bt.perception.clip.word_tower import WORDS, WordTower

CONFIG = "open_clip_config.json"
"""The file that makes a folder a model, beside its weights."""
WEIGHTS = "open_clip_model.safetensors"
"""The weights in folders that are written here; others are read, too."""
SHIPPED = {"zavis-tiny": Path(__file__).parents[1] / "weights" / "zavis_tiny_clip"}
"""Models that come with the package."""

LIT = "-lit"
"""Ends the names of models that read texts by static word vectors: ``zavis-tiny-lit``, ``FOLDER-lit``."""


@dataclass(frozen=True, slots=True)
class Parts:
    """A model with what stands before it."""

    network: nn.Module
    tokenizer: Tokenizer
    preprocessing: Preprocessing


def load_parts(model: str, pretrained: str | None) -> Parts:
    """Return a model with its weights.

    Args:
        model: Name of a shipped model or of one of open_clip's, or a folder with `CONFIG` and weights.
        pretrained: For open_clip's models: tag of published weights, or a file of weights.

    Raises:
        InputError: There is no such model, or its weights cannot be had or do not fit.
    """
    if model.endswith(LIT):
        return _with_word_tower(model.removesuffix(LIT), pretrained)
    folder = folder_of(model)
    if folder is not None:
        _check_folder(folder, pretrained)
        return _build(f"local-dir:{folder}", None, where=str(folder), required=True)
    _check_name(model)
    if pretrained is None:
        tags = ", ".join(open_clip.list_pretrained_tags_by_model(model)[:6])
        raise InputError(f"CLIP model {model}: no weights named (pretrained: a file, or a tag{_such_as(tags)})")
    tagged = pretrained in open_clip.list_pretrained_tags_by_model(model)
    if not tagged and not Path(pretrained).is_file():
        raise InputError(f"CLIP model {model}: weights '{pretrained}' are neither a file nor a published tag")
    return _build(model, pretrained, where=f"CLIP model {model}, weights '{pretrained}'", required=True)


def build_untrained(model: str, weights: Path | None = None) -> Parts:
    """Return a model to be trained, with random weights or those of a file.

    Args:
        model: Name of a shipped model or of one of open_clip's, or a folder with `CONFIG`.
        weights: File to begin with.

    Raises:
        InputError: There is no such model, or the weights do not fit.
    """
    folder = folder_of(model)
    if folder is None:
        _check_name(model)
    else:
        _check_folder(folder, None)
    where = f"CLIP model {model}"
    parts = _build(model if folder is None else f"local-dir:{folder}", None, where=where, required=False)
    if weights is not None:
        if not weights.is_file():
            raise InputError(f"{weights}: there is no such file (weights of {model})")
        with _loading(weights):
            load_checkpoint(parts.network, str(weights))
    return parts


def model_config(model: str) -> dict[str, Any]:
    """Return the architecture of a model in open_clip's form; ``model`` as for `build_untrained`."""
    folder = folder_of(model)
    return dict(get_model_config(model if folder is None else f"local-dir:{folder}"))


def _with_word_tower(model: str, pretrained: str | None) -> Parts:
    folder = folder_of(model)
    if folder is None or not (folder / WORDS).is_file():
        raise InputError(f"{model}{LIT}: has no word tower (train one: zavis matcher lit FOLDER)")
    parts = load_parts(model, pretrained)
    with _loading(folder / WORDS):
        tower = WordTower.load(parts.network, folder / WORDS)
    return Parts(tower.eval(), tower.tokenise, parts.preprocessing)


def logit_scale(network: nn.Module) -> float:
    """Return the factor of cosines with which a model was trained; 100 for CLIP."""
    return math.exp(float(network.get_parameter("logit_scale").detach()))


def folder_of(model: str) -> Path | None:
    """Return the folder of a shipped model or of the user's; None for open_clip's names."""
    return SHIPPED.get(model) or (Path(model) if _is_path(model) else None)


def _is_path(model: str) -> bool:
    return "/" in model or "\\" in model or model.startswith(".") or Path(model).is_dir()


def _such_as(tags: str) -> str:
    return f" such as {tags}" if tags else ""


def _check_name(model: str) -> None:
    if get_model_config(model) is None:
        hint = did_you_mean(model, [*open_clip.list_models(), *SHIPPED])
        raise InputError(f"CLIP model '{model}' is unknown{hint or ' (a name of open_clip, or a folder)'}")


def _check_folder(folder: Path, pretrained: str | None) -> None:
    if pretrained is not None:
        raise InputError(f"{folder}: brings its own weights (leave '{pretrained}' out)")
    if not (folder / CONFIG).is_file():
        raise InputError(f"{folder}: is no CLIP model (a folder with {CONFIG} and {WEIGHTS})")


def _build(model: str, pretrained: str | None, *, where: str, required: bool) -> Parts:
    with _loading(where), _quiet():
        network, _, _ = open_clip.create_model_and_transforms(
            model, pretrained=pretrained, require_pretrained=required, load_weights=required
        )
        tokenizer = open_clip.get_tokenizer(model)
    return Parts(network.eval(), _knowing(tokenizer, network), _preprocessing(network))


@contextmanager
def _loading(where: Path | str) -> Iterator[None]:
    """Tell in one line what cannot be loaded."""
    try:
        yield
    except Exception as error:  # open_clip, torch, safetensors and the hub share no type for bad files and networks
        raise InputError(f"{where}: cannot be loaded: {_first_line(error)}") from error


def _knowing(tokenizer: Tokenizer, network: nn.Module) -> Tokenizer:
    """Return the tokenizer, without words that the network never learnt if there are such."""
    embedding = getattr(network, "token_embedding", None)
    if not isinstance(embedding, nn.Embedding) or bool((embedding.weight != 0).any(dim=1).all()):
        return tokenizer
    return KnownWords(tokenizer, embedding.weight.detach())


def _first_line(error: BaseException) -> str:
    """Return the point of an error; a list of mismatched weights is cut to what it means."""
    text = str(error)
    if "state_dict" in text or "size mismatch" in text:
        return "the weights belong to another architecture (give the model name they were made for)"
    if any(word in text for word in ("Failed to download", "couldn't connect", "offline", "resolve")):
        return "the weights could not be downloaded (fetch the file elsewhere and give its path)"
    if "could not be loaded" in text:
        return f"there are no weights (put {WEIGHTS} beside {CONFIG})"
    line = " ".join(text.split())[:160]
    return f"{line or type(error).__name__} (is the file complete? fetch it again)"


def _preprocessing(network: nn.Module) -> Preprocessing:
    wanted = open_clip.get_model_preprocess_cfg(network)
    size = wanted["size"]
    side = int(size if isinstance(size, int) else size[0])
    mean, std = (tuple(map(float, wanted[name])) for name in ("mean", "std"))
    assert len(mean) == 3
    assert len(std) == 3
    return Preprocessing(side, mean, std, str(wanted.get("interpolation", "bicubic")))


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep open_clip from writing its course of action into everybody's log."""
    logger = logging.getLogger()
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)


def read_facts(model: str) -> dict[str, Any]:
    """Return what a model's folder says of its training; empty if nothing, and for open_clip's names."""
    folder = folder_of(model.removesuffix(LIT))
    if folder is None:
        return {}
    facts = json.loads((folder / CONFIG).read_text()).get("training", {})
    return dict(facts) if isinstance(facts, dict) else {}
