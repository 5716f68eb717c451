"""Which models there are, and where each comes from."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from zavis_bt.documents import check, read_document
from zavis_bt.errors import InputError

WEIGHTS = Path(str(files("zavis_bt.perception"))) / "weights"
"""Folder of the weights that come along."""

_MANIFEST = Path(__file__).with_name("manifest.yaml")
_HUB = "https://huggingface.co"

Form = Literal["file", "open_clip", "transformers"]
"""One weights file, a folder as open_clip loads it, or a folder as transformers loads it."""
Text = Annotated[str, Field(min_length=1)]


class ModelEntry(BaseModel):
    """What is known of a model before it is here."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    purpose: Text
    form: Form
    licence: Text
    trained_on: Text
    model_type: Text | None = None
    """Architecture in the ``config.json`` of transformers."""
    shipped: Text | None = None
    """Path below the folder of the weights that come along."""
    hub: Text | None = None
    """Repository on the hub."""
    url: Text | None = None
    """Address of a single file."""
    files: tuple[Text, ...] = ()
    """What to fetch; ``a | b`` where either will do."""
    megabytes: Annotated[float, Field(gt=0)] | None = None
    """Roughly what there is to fetch."""

    @model_validator(mode="after")
    def _one_source(self) -> ModelEntry:
        if sum(source is not None for source in (self.shipped, self.hub, self.url)) != 1:
            raise ValueError("should have exactly one of shipped, hub and url")
        if bool(self.files) == bool(self.shipped):
            raise ValueError("files should be named for what is fetched, and only for that")
        return self

    @property
    def page(self) -> str:
        """Where a person finds it; empty for what comes along."""
        return f"{_HUB}/{self.hub}" if self.hub else self.url or ""

    def alternatives(self) -> list[tuple[str, ...]]:
        """Return the names under which each file may be found, the best first."""
        return [tuple(name.strip() for name in names.split("|")) for names in self.files]


class _Manifest(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal["zavis-models/1"]
    models: dict[Text, ModelEntry]


@lru_cache(maxsize=1)
def manifest() -> Mapping[str, ModelEntry]:
    """Return all models by name.

    Raises:
        InputError: The file that comes along was changed and is wrong.
    """
    found, faults = check(read_document(_MANIFEST), _Manifest)
    if found is None:
        raise InputError("\n".join(faults))
    return found.models


def remedy(name: str) -> str:
    """Return what to do to get a model that is not here, as one line."""
    entry = manifest().get(name)
    if entry is None or entry.shipped:
        return by_hand(name)
    return f"get it: zavis models add {name}; without a network {by_hand(name)}"


def by_hand(name: str) -> str:
    """Return how to get a model without this program's help, as one line."""
    entry = manifest().get(name)
    if entry is None:
        return f"add yours: zavis models add {name} FILE|FOLDER"
    if entry.shipped:
        return "it should come along: install zavis_bt again"
    if entry.url:
        return f"download {entry.url}, then: zavis models add {name} FILE"
    wanted = ", ".join(" or ".join(names) for names in entry.alternatives())
    return f"download {wanted} from {entry.page} into a folder, then: zavis models add {name} FOLDER"
