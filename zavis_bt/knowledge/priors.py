"""Knowledge priors by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.knowledge.comet import comet
from zavis_bt.knowledge.commonsense_prior import CommonsensePrior
from zavis_bt.knowledge.simple_priors import UniformPrior, WordPrior
from zavis_bt.knowledge.table import load_table
from zavis_bt.knowledge.vectors import word_vectors
from zavis_bt.protocols import KnowledgePrior

ENTRY_POINT_GROUP = "zavis_bt.priors"


def commonsense(
    table: Path | str | None = None, *, neighbours: int = 5, floor: float = 0.3, decay: float = 0.05
) -> KnowledgePrior:
    """Make the prior of a commonsense table; see `CommonsensePrior`.

    Args:
        table: File as `load_table` reads it; None for the built-in table.
        neighbours: Objects of the table that stand in for a target it does not hold, at least 1.
        floor: Cosine at which two places count as unrelated, at least 0 and below 1.
        decay: What each further place of an object's list loses of its weight, 0 to 1.

    Raises:
        InputError: The table or a setting is wrong.
    """
    if neighbours < 1:
        raise InputError(f"prior 'commonsense': neighbours is {neighbours} (at least 1)")
    if not 0.0 <= floor < 1.0:
        raise InputError(f"prior 'commonsense': floor is {floor} (0 or more, below 1)")
    if not 0.0 <= decay <= 1.0:
        raise InputError(f"prior 'commonsense': decay is {decay} (0 to 1)")
    return CommonsensePrior(load_table(table), word_vectors(), neighbours=neighbours, floor=floor, decay=decay)


def word() -> KnowledgePrior:
    """Make the prior of the word-similarity ablation; see `WordPrior`."""
    return WordPrior(word_vectors())


def none() -> KnowledgePrior:
    """Make the prior that knows nothing; see `UniformPrior`."""
    return UniformPrior()


PRIORS: dict[str, Callable[..., KnowledgePrior]] = {
    "commonsense": commonsense,
    "comet": comet,
    "word": word,
    "none": none,
}


def make_prior(name: str, **settings: Any) -> KnowledgePrior:
    """Make a knowledge prior by its name: one of `PRIORS`, or an entry point of the group ``zavis_bt.priors``.

    Args:
        name: Name of the prior.
        settings: Arguments of the prior's factory.

    Raises:
        InputError: There is no such prior, or it has no such setting.
    """
    factory = PRIORS.get(name) or _load(name)
    try:
        inspect.signature(factory).bind(**settings)
    except TypeError as error:
        choices = ", ".join(inspect.signature(factory).parameters) or "none"
        raise InputError(f"prior '{name}': {error} (settings: {choices})") from error
    return factory(**settings)


def _load(name: str) -> Callable[..., KnowledgePrior]:
    installed = {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}
    if name not in installed:
        raise InputError(f"prior '{name}': there is none of that name{did_you_mean(name, {*PRIORS, *installed})}")
    factory: Callable[..., KnowledgePrior] = installed[name].load()
    return factory
