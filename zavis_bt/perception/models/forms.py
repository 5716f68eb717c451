"""Whether files are what a model is made of: told from their form, without loading them."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

from zavis_bt.errors import InputError
from zavis_bt.perception.models.manifest import Form

OPEN_CLIP_CONFIG, TRANSFORMERS_CONFIG = "open_clip_config.json", "config.json"
_WEIGHTS = (".safetensors", ".pt", ".pth", ".bin")
_TOKENIZERS = (("tokenizer.json",), ("vocab.json", "merges.txt"), ("vocab.txt",))
_LEGACY_TORCH = b"\x80\x02\x8a\nl\xfc\x9cF\xf9 j\xa8P\x19."  # the number that torch wrote first before its zip format
_MISTAKEN = {
    b"version https://git-lfs": "is only git-lfs's note of where the file is (git lfs pull, or download the file)",
    b"<!DOCTYPE": "is a web page (download the file itself)",
    b"<html": "is a web page (download the file itself)",
}


def check_form(path: Path, form: Form | None = None, model_type: str | None = None) -> None:
    """Check the form of a file or folder.

    Args:
        path: What is to be a model.
        form: What it must be; None for whatever it shows to be.
        model_type: Architecture that the ``config.json`` of transformers must name; None for any.

    Raises:
        InputError: It is of another form, incomplete or damaged.
    """
    if not path.exists():
        raise InputError(f"{path}: no such file or folder")
    if not path.is_dir():
        if form not in (None, "file"):
            raise InputError(f"{path}: is one file (a folder with {_config_name(form)} and its weights is needed)")
        check_weights_file(path)
        return
    if form == "file":
        raise InputError(f"{path}: is a folder (one weights file is needed)")
    _check_folder(path, form, model_type)


def check_weights_file(path: Path) -> None:
    """Check a weights file: safetensors, or what torch saves.

    Raises:
        InputError: It cannot be read, is something else, or is incomplete.
    """
    try:
        with path.open("rb") as stream:
            head = stream.read(32)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    if not head:
        raise InputError(f"{path}: is empty (download it again)")
    for start, problem in _MISTAKEN.items():
        if head.lower().startswith(start.lower()):
            raise InputError(f"{path}: {problem}")
    if path.suffix == ".safetensors":
        _check_safetensors(path)
    elif head.startswith(b"PK"):
        _check_torch_zip(path)
    elif not head.startswith(_LEGACY_TORCH):
        raise InputError(f"{path}: holds no weights (.safetensors, or .pt, .pth, .bin as torch saves them)")


def weights_in(folder: Path) -> list[Path]:
    """Return the weights files right in the folder."""
    return sorted(path for path in folder.iterdir() if path.suffix in _WEIGHTS and path.is_file())


def _check_safetensors(path: Path) -> None:
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="np") as opened:  # compares the header with the length of the file
            named = len(opened.keys())
    except SafetensorError as error:
        raise InputError(f"{path}: is damaged or incomplete: {error} (download it again)") from error
    if not named:
        raise InputError(f"{path}: holds no tensors (download it again)")


def _check_torch_zip(path: Path) -> None:
    try:
        with zipfile.ZipFile(path) as archive:  # its table is at the end: incomplete files have none
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError) as error:
        raise InputError(f"{path}: is damaged or incomplete: {error} (download it again)") from error
    if not any(name.endswith("data.pkl") for name in names):
        raise InputError(f"{path}: is a zip archive, but not one that torch saved (unpack it first)")


def _check_folder(folder: Path, form: Form | None, model_type: str | None) -> None:
    config = _config_name(form or _form_of(folder))
    if config is not None:
        content = _read_config(folder / config)
        if config == TRANSFORMERS_CONFIG:
            _check_transformers(folder, content, model_type)
        elif not isinstance(content.get("model_cfg"), dict):
            raise InputError(f"{folder / config}: has no model_cfg (a configuration as open_clip writes it)")
    weights = weights_in(folder)
    if not weights:
        raise InputError(f"{folder}: holds no weights ({', '.join('*' + suffix for suffix in _WEIGHTS)})")
    for path in weights:
        check_weights_file(path)


def _check_transformers(folder: Path, config: dict[str, Any], model_type: str | None) -> None:
    found = config.get("model_type")
    if not isinstance(found, str) or model_type not in (None, found):
        raise InputError(
            f"{folder / TRANSFORMERS_CONFIG}: model_type is {found!r} ({model_type or 'a name'} is needed)"
        )
    if not any(all((folder / name).is_file() for name in names) for names in _TOKENIZERS):
        choices = ", ".join(" with ".join(names) for names in _TOKENIZERS)
        raise InputError(f"{folder}: holds no tokenizer (one of: {choices})")


def _form_of(folder: Path) -> Form | None:
    if (folder / OPEN_CLIP_CONFIG).is_file():
        return "open_clip"
    return "transformers" if (folder / TRANSFORMERS_CONFIG).is_file() else None


def _config_name(form: Form | None) -> str | None:
    return {"open_clip": OPEN_CLIP_CONFIG, "transformers": TRANSFORMERS_CONFIG}.get(form or "")


def _read_config(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: is missing (it belongs to the model)") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise InputError(f"{path}: is not JSON: {error} (download it again)") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: is no configuration (download it again)")
    return content
