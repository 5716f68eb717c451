"""Composing eyes: simulated ones by the simulator's frames, neural and others by name or file."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.perception import (
    FITTED_THRESHOLDS,
    FITTED_TO_NETWORKS,
    DetectorSettings,
    MatcherSettings,
    SimDetector,
    SimMatcher,
)
from zavis_bt.errors import InputError
from zavis_bt.perception import Eyes, EyesSettings, Thresholds, open_eyes, split_landmarks
from zavis_bt.perception.eyes import find_eyes, is_file

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy as np

    from zavis_bt.mission import Search

SIMULATED = "simulated"
FITTED = "fitted"
"""Simulated, too, but with the errors of the networks that come along, not those of published ones."""
_SIMULATED = (SIMULATED, FITTED)


def check_perception(name: str) -> None:
    """Refuse a name of eyes that there are not; no weights are loaded.

    Raises:
        InputError: There are no eyes of that name, or the file is missing or wrong.
    """
    if is_simulated(name):
        return
    if is_file(name):
        from zavis_bt.perception.eyes_file import read_eyes

        read_eyes(Path(name))
    else:
        find_eyes(name, others=_SIMULATED)


def is_simulated(name: str) -> bool:
    """Return whether eyes look at what frames say they show, not at pixels."""
    return name in _SIMULATED


def eyes_of(
    name: str,
    known: Sequence[str],
    rng: Callable[[str], np.random.Generator],
    similarity: Callable[[str, str], float],
    *,
    threads: int | None = None,
) -> Eyes:
    """Make the eyes of a mission.

    Args:
        name: ``simulated``, ``fitted``, or what `open_eyes` takes.
        known: Landmarks that simulated eyes are trained on.
        rng: Returns the generator of a consumer, for simulated eyes.
        similarity: Returns how alike two names are, for simulated eyes.
        threads: CPU threads of networks; None for the library's choice.

    Raises:
        InputError: There are no such eyes, or their weights cannot be had.
    """
    if is_simulated(name):
        detector, matcher = FITTED_TO_NETWORKS if name == FITTED else (DetectorSettings(), MatcherSettings())
        return Eyes(
            SimDetector(known, rng("detector"), detector),
            SimMatcher(similarity, rng("matcher"), matcher),
            Thresholds(**FITTED_THRESHOLDS) if name == FITTED else Thresholds(),
            about={"detector": asdict(detector), "matcher": asdict(matcher)},
        )
    return open_eyes(name, EyesSettings(threads=threads), others=_SIMULATED)


def with_landmarks_of(eyes: Eyes, search: Search) -> Search:
    """Return the search with its landmarks sorted into those that the eyes' detector knows, and the others.

    Raises:
        InputError: A name occurs twice.
    """
    if eyes.classes is None:
        return search
    known, unknown = split_landmarks((*search.known, *search.unknown), eyes.classes)
    return replace(search, known=known, unknown=unknown)


def eyes_in_records(eyes: Eyes) -> dict[str, Any]:
    """Return what decides how eyes see, as JSON's types."""
    about = {**eyes.about, "thresholds": asdict(eyes.thresholds)}
    return dict(json.loads(json.dumps(about, default=str)))


def needs_simulator(what: str, instead: str) -> InputError:
    """Return the refusal of what only the simulator's camera makes possible.

    Args:
        what: What was asked for, and where.
        instead: What would do.
    """
    return InputError(
        f"{what}: needs the simulator's camera, whose frames say what they show "
        f"(devices.camera.driver: sim; or choose {instead})"
    )
