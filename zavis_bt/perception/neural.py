"""Neural eyes: an open-set detector and CLIP, with our weights or the user's."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from zavis_bt.errors import InputError
from zavis_bt.perception.calibration import Thresholds
from zavis_bt.perception.contrast import ContrastMatcher
from zavis_bt.perception.eyes import Eyes, EyesSettings
from zavis_bt.perception.eyes_file import read_eyes
from zavis_bt.perception.models import WEIGHTS, ModelStore, find_weights
from zavis_bt.perception.several_scales import SeveralScales
from zavis_bt.protocols import Detector, Matcher

DETECTOR, CLIP = "zavis-tiny-detector", "zavis-tiny"
"""Weights that come along; trained on rendered images."""
_LIBRARIES = ("torch", "torchvision", "open_clip")
_EXTRA = "pip install 'zavis_bt[neural]'"
_PAPERS_MODEL = "vit-b-32"  # whose threshold of 29 the paper gives


def open_eyes(settings: EyesSettings) -> Eyes:
    """Make neural eyes; those of the same settings are made once in a process.

    Args:
        settings: Weights; the small ones that come along if not given. Thresholds; those that belong to the
            image-text model if not given.

    Raises:
        InputError: Torch is not installed, weights or thresholds cannot be had, or do not belong together.
    """
    missing = [library for library in _LIBRARIES if find_spec(library) is None]
    if missing:
        raise InputError(f"{settings.where}: neural: needs {missing[0]} ({_EXTRA})")
    return _opened(settings)


@lru_cache(maxsize=2)
def _opened(settings: EyesSettings) -> Eyes:
    """Make eyes; what is wrong with the settings or the files is told before torch is loaded, which takes seconds."""
    detector_name, clip_name = settings.detector or DETECTOR, settings.clip or CLIP
    file = find_weights(detector_name)
    architecture, pretrained, weights = find_clip(clip_name)
    checksums = {"detector": checksum(file)} | ({"clip": checksum(weights)} if weights else {})
    check_checksums(settings, checksums)
    settings = with_meaning(settings)
    from zavis_bt.perception.clip import ClipMatcher, ClipModel
    from zavis_bt.perception.detector import NeuralDetector

    _prepare(settings)
    scales = [NeuralDetector.load(file, device=settings.device, width=width) for width in settings.widths or (None,)]
    detector: Detector = (
        scales[0] if len(scales) == 1 else SeveralScales(dict(zip(settings.widths, scales, strict=True)))
    )
    matcher: Matcher = ClipMatcher(ClipModel.load(architecture, pretrained, device=settings.device))
    if settings.contrast is not None:
        matcher = ContrastMatcher(matcher, settings.contrast)
    about: dict[str, Any] = {"detector": detector_name, "clip": clip_name, "sha256": checksums}
    about |= {"device": settings.device, "widths": list(settings.widths), "relative": settings.contrast is not None}
    return Eyes(detector, matcher, settings.thresholds or Thresholds(), tuple(scales[0].classes), about)


def find_clip(name: str) -> tuple[str, str | None, Path | None]:
    """Return what an image-text model is loaded by: architecture or folder, weights or tag, and where its file is.

    Args:
        name: Of weights as `find_weights` knows them, a folder, or ``MODEL@PRETRAINED`` of open_clip, of which the
            second part is a tag or a file.

    Raises:
        InputError: The weights are missing or damaged.
    """
    model, at, pretrained = name.partition("@")
    if at:
        return model, pretrained, Path(pretrained) if Path(pretrained).is_file() else None
    if "/" in name or Path(name).exists() or name in ModelStore().names():
        folder = find_weights(name)
        return str(folder), None, folder
    return name, None, None


def _prepare(settings: EyesSettings) -> None:
    """Set what holds for all networks of the process."""
    import torch

    if settings.device.partition(":")[0] not in ("cpu", "cuda"):
        raise InputError(f"{settings.where}: device: '{settings.device}' is unknown (cpu or cuda)")
    if settings.device != "cpu" and not torch.cuda.is_available():
        raise InputError(f"{settings.where}: device: '{settings.device}' is not there (choose cpu)")
    if settings.threads is not None:
        torch.set_num_threads(settings.threads)


def with_meaning(settings: EyesSettings) -> EyesSettings:
    """Return the settings with thresholds and all that belongs to them: as given, or as they come along with a model.

    Raises:
        InputError: None are given, and none come along with this model.
    """
    if settings.thresholds is not None:
        return settings
    clip = settings.clip or CLIP
    shipped = WEIGHTS / f"{clip}.eyes.yaml"
    if shipped.is_file():
        _, known = read_eyes(shipped)
        widths = settings.widths or (known.widths if settings.detector in (None, known.detector) else ())
        return replace(settings, thresholds=known.thresholds, contrast=known.contrast, widths=widths)
    if clip.lower().startswith(_PAPERS_MODEL):
        return replace(settings, thresholds=Thresholds(), contrast=None)
    raise InputError(
        f"{settings.where}: clip: no thresholds are known for '{clip}' "
        f"(measure them: zavis perception calibrate DATA --clip {clip} --out my.eyes.yaml)"
    )


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file, or of the files of a folder by name."""
    if path.is_dir():
        digest = hashlib.sha256()
        for file in sorted(child for child in path.iterdir() if child.is_file()):
            digest.update(f"{file.name}:{checksum(file)}\n".encode())
        return digest.hexdigest()
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def check_checksums(settings: EyesSettings, found: Mapping[str, str]) -> None:
    """Refuse weights that the thresholds were not measured with.

    Args:
        settings: Whose checksums are compared.
        found: SHA-256 of the weights at hand, by ``detector`` and ``clip``.

    Raises:
        InputError: One is another.
    """
    for kind, expected in settings.checksums:
        if kind in found and found[kind] != expected:
            raise InputError(
                f"{settings.where}: the thresholds were measured with another {kind} (SHA-256 {expected[:12]}…, this "
                f"one has {found[kind][:12]}…; measure again: zavis perception calibrate DATA --out {settings.where})"
            )
