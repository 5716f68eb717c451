"""Kinds of behaviours by name."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import EntryPoint, entry_points
from types import ModuleType
from typing import Any

from zavis_bt.errors import InputError
from zavis_bt.tree.behaviour import Behaviour

GROUP = "zavis_bt.behaviours"
"""Entry point group: each entry names a module whose ``__all__`` holds behaviours, or one behaviour."""


class Registry(Mapping[str, type[Behaviour]]):
    """Maps kind names to behaviour classes."""

    def __init__(self, classes: Iterable[type[Behaviour]] = ()) -> None:
        """Register classes under their kind names.

        Raises:
            InputError: Two different classes have the same kind name.
        """
        self._classes: dict[str, type[Behaviour]] = {}
        for class_ in classes:
            known = self._classes.setdefault(class_.kind, class_)
            if known is not class_:
                raise InputError(f"kind '{class_.kind}' is defined twice: by {_origin(known)} and {_origin(class_)}")

    @classmethod
    def from_entry_points(cls) -> Registry:
        """Return the behaviours of all installed distributions.

        Raises:
            InputError: An entry point cannot be loaded or holds no behaviour.
        """
        found = [class_ for entry in entry_points(group=GROUP) for class_ in _load(entry)]
        return cls(dict.fromkeys(found))

    def __getitem__(self, kind: str) -> type[Behaviour]:
        return self._classes[kind]

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._classes))

    def __len__(self) -> int:
        return len(self._classes)


def _origin(class_: type[Behaviour]) -> str:
    return f"{class_.__module__}.{class_.__qualname__}"


def _load(entry: EntryPoint) -> list[type[Behaviour]]:
    try:
        target = entry.load()
    except (ImportError, AttributeError) as error:
        raise InputError(f"entry point '{entry.name}' = {entry.value}: {error}") from error
    classes = behaviours_of(target)
    if not classes:
        raise InputError(f"entry point '{entry.name}' = {entry.value}: no behaviour in it (a module needs __all__)")
    return classes


def behaviours_of(target: Any) -> list[type[Behaviour]]:
    """Return the behaviours among a module's public names, or the class itself if it is a behaviour."""
    members = [target]
    if isinstance(target, ModuleType):
        members = [getattr(target, name) for name in getattr(target, "__all__", ())]
    return [member for member in members if inspect.isclass(member) and issubclass(member, Behaviour)]
