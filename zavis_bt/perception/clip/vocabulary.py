"""Words for things beyond their category's name: synonyms, and names of whole groups."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from zavis_bt.errors import InputError

HOUSEHOLD_WORDS = Path(__file__).with_name("household_words.json")
"""Words for the things of a home."""


class _Document(BaseModel):
    model_config = ConfigDict(extra="forbid")
    kinds: dict[str, list[str]] = {}
    groups: dict[str, list[str]] = {}
    synonyms: dict[str, list[str]] = {}
    twins: list[list[str]] = []
    tested_synonyms: list[str] = []
    colour_synonyms: dict[str, list[str]] = {}


@dataclass(frozen=True)
class Vocabulary:
    """What things are called."""

    kinds: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Of each of the paper's eleven object prompts: the categories it is nearest to. A prompt may have none."""
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Of other words for several categories, such as ``fruit``: the categories."""
    synonyms: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Of a category: its other names."""
    twins: tuple[tuple[str, ...], ...] = ()
    """Categories that look much alike; evaluation also counts each set as one."""
    tested_synonyms: tuple[str, ...] = ()
    """Synonyms that evaluation asks for."""
    colour_synonyms: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Of a colour: its other names."""

    @classmethod
    def read(cls, path: Path = HOUSEHOLD_WORDS) -> Vocabulary:
        """Read a file of words.

        Raises:
            InputError: The file cannot be read or is no file of words.
        """
        try:
            document = _Document.model_validate_json(path.read_bytes())
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror} (a JSON file of words)") from error
        except ValidationError as error:
            fault = error.errors()[0]
            where = ".".join(map(str, fault["loc"])) or "document"
            raise InputError(f"{path}: {where}: {fault['msg']} (like {HOUSEHOLD_WORDS})") from error
        return cls(
            _frozen(document.kinds),
            _frozen(document.groups),
            _frozen(document.synonyms),
            tuple(map(tuple, document.twins)),
            tuple(document.tested_synonyms),
            _frozen(document.colour_synonyms),
        )

    def without(self, words: tuple[str, ...]) -> Vocabulary:
        """Return the vocabulary without some synonyms."""
        kept = {name: tuple(w for w in others if w not in words) for name, others in self.synonyms.items()}
        return replace(self, synonyms=kept)

    def category_of(self, synonym: str) -> str | None:
        """Return the category a synonym stands for."""
        return next((name for name, others in self.synonyms.items() if synonym in others), None)


def _frozen(words: Mapping[str, list[str]]) -> dict[str, tuple[str, ...]]:
    return {word: tuple(others) for word, others in words.items()}
