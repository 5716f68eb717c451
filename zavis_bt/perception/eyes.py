"""Eyes: a detector, a matcher and the thresholds that belong to them, made by name.

`open_eyes` makes the eyes that a name or a settings file asks for. Entry points of the group ``zavis_bt.perception``
are functions that take `EyesSettings` and return `Eyes`; `neural` is one of them, users add theirs. Simulated
perception needs the simulator and is made by whoever has one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.perception.calibration import Thresholds
from zavis_bt.perception.contrast import Contrast
from zavis_bt.protocols import Detector, Matcher

ENTRY_POINT_GROUP = "zavis_bt.perception"
BUILT_IN = (EntryPoint("neural", "zavis_bt.perception.neural:open_eyes", ENTRY_POINT_GROUP),)


@dataclass(frozen=True, slots=True)
class EyesSettings:
    """Which weights to see with. What is None is left to the eyes."""

    detector: str | None = None
    """Name of weights, or their file."""
    clip: str | None = None
    """Image-text model: a name, ``MODEL@PRETRAINED`` of open_clip, or a folder."""
    device: str = "cpu"
    """``cpu`` or ``cuda``."""
    widths: tuple[int, ...] = ()
    """To which images are scaled down for the detector [px], which looks at each; its own if none is given."""
    threads: int | None = None
    """CPU threads of the networks; None for the library's choice. Results may differ in the last digits."""
    thresholds: Thresholds | None = None
    """What the scores of these weights mean."""
    contrast: Contrast | None = None
    """What scores are relative to; None for plain ones. Belongs to the thresholds."""
    checksums: tuple[tuple[str, str], ...] = ()
    """SHA-256 of the weights, by ``detector`` and ``clip``, that the thresholds were measured with."""
    options: Mapping[str, Any] = field(default_factory=dict, hash=False)
    """Further settings of eyes that are not ours."""
    where: str = "--perception"
    """To begin error messages with."""


@dataclass(frozen=True, slots=True)
class Eyes:
    """What a mission sees with."""

    detector: Detector
    matcher: Matcher
    thresholds: Thresholds = field(default_factory=Thresholds)
    classes: tuple[str, ...] | None = None
    """The detector's known classes; None if it takes the mission's known landmarks for them."""
    about: Mapping[str, Any] = field(default_factory=dict)
    """Names, checksums and origin of the weights, for the records of a run."""


EyesFactory = Callable[[EyesSettings], Eyes]


def eyes_names() -> tuple[str, ...]:
    """Return the names of the eyes that are installed."""
    return tuple(sorted(_installed()))


def open_eyes(name: str, settings: EyesSettings | None = None, *, others: tuple[str, ...] = ()) -> Eyes:
    """Make eyes.

    Args:
        name: ``neural``, another entry point of the group ``zavis_bt.perception``, or a ``zavis-eyes/1`` file.
        settings: Weights and the like. A file says these itself: only its threads are taken from here.
        others: Names that the caller makes itself, for the error message.

    Raises:
        InputError: There are no such eyes, or their weights cannot be had.
    """
    settings = settings or EyesSettings()
    if is_file(name):
        from zavis_bt.perception.eyes_file import read_eyes

        name, of_file = read_eyes(Path(name))
        settings = replace(of_file, threads=settings.threads)
    factory: EyesFactory = find_eyes(name, others=others).load()
    return factory(settings)


def find_eyes(name: str, *, others: tuple[str, ...] = ()) -> EntryPoint:
    """Return the entry point of eyes.

    Args:
        name: Of an entry point.
        others: Names that the caller makes itself, for the error message.

    Raises:
        InputError: There are no such eyes.
    """
    installed = _installed()
    if name not in installed:
        choices = {*installed, *others}
        raise InputError(f"--perception: '{name}' is unknown{did_you_mean(name, choices)}")
    return installed[name]


def _installed() -> dict[str, EntryPoint]:
    return {point.name: point for point in (*entry_points(group=ENTRY_POINT_GROUP), *BUILT_IN)}


def is_file(name: str) -> bool:
    """Return whether the name of eyes is a file's."""
    return Path(name).suffix in (".yaml", ".yml")
