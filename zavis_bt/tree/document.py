"""A YAML file as nodes that know their places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, ScalarNode, SequenceNode

from zavis_bt.errors import InputError
from zavis_bt.tree.faults import Faults, Mark

MAX_DEPTH = 60
"""Nesting that no person writes; deeper files would exhaust Python's stack."""

TEXT_TAGS = ("str", "timestamp", "value", "merge")
"""What YAML calls values that are texts here."""


@dataclass(frozen=True, slots=True)
class Scalar:
    """A single value: str, int, float, bool or None."""

    value: str | int | float | bool | None
    mark: Mark

    @property
    def plain(self) -> Any:
        """The value without places."""
        return self.value


@dataclass(frozen=True, slots=True)
class Items:
    """A list."""

    items: tuple[Element, ...]
    mark: Mark

    @property
    def plain(self) -> list[Any]:
        """The values without places."""
        return [item.plain for item in self.items]


@dataclass(frozen=True, slots=True)
class Table:
    """A mapping from text to elements; keys keep their places."""

    entries: dict[str, Element]
    keys: dict[str, Mark]
    mark: Mark

    @property
    def plain(self) -> dict[str, Any]:
        """The values without places."""
        return {key: value.plain for key, value in self.entries.items()}

    def get(self, key: str) -> Element | None:
        """Return the element under a key, or None."""
        return self.entries.get(key)

    def __iter__(self) -> Iterator[str]:
        return iter(self.entries)


Element = Scalar | Items | Table


def read_document(path: Path, faults: Faults, name: str = "") -> Element | None:
    """Return the content of a YAML file, or None if it cannot be read; faults go to the collector.

    Args:
        path: The file.
        faults: Takes what is wrong with the file's form.
        name: How messages call the file.

    Raises:
        InputError: The file does not exist or is no text.
    """
    name = name or str(path)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{name}: cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{name}: is no UTF-8 text: {error.reason} at byte {error.start}") from error
    element, found = parse_document(text, name)
    faults.found.extend(found.found)
    return element


@lru_cache(maxsize=64)
def parse_document(text: str, name: str) -> tuple[Element | None, Faults]:
    """Return the content of a YAML text and what is wrong with its form; the same text is read once."""
    faults = Faults()
    try:
        root = YAML(typ="safe", pure=True).compose(text)
        return (Scalar(None, Mark(name, 1, 1)) if root is None else _Reader(name, faults).read(root)), faults
    except MarkedYAMLError as error:
        place = error.problem_mark or error.context_mark
        mark = Mark(name, place.line + 1, place.column + 1) if place else Mark(name, 1, 1)
        faults.add(mark, "syntax", ", ".join(filter(None, (error.problem, error.context))))
    except YAMLError as error:
        faults.add(Mark(name, 1, 1), "syntax", " ".join(str(error).split()))
    except RecursionError:
        faults.add(Mark(name, 1, 1), "syntax", f"nested too deeply (at most {MAX_DEPTH} levels)")
    except Exception as error:  # whatever else the scanner stumbles over (bad directives, escapes) is the file's fault
        faults.add(Mark(name, 1, 1), "syntax", f"{type(error).__name__}: {error}")
    return None, faults


class _Reader:
    """Turns composed YAML nodes into elements."""

    def __init__(self, name: str, faults: Faults) -> None:
        self._name = name
        self._faults = faults
        self._seen: set[int] = set()
        self._constructor = YAML(typ="safe", pure=True).constructor

    def read(self, node: Any, depth: int = 0) -> Element:
        mark = self._mark(node)
        if isinstance(node, ScalarNode):
            return Scalar(self._scalar(node, mark), mark)
        if depth > MAX_DEPTH:
            self._faults.add(mark, "syntax", f"nested too deeply (at most {MAX_DEPTH} levels)")
            return Scalar(None, mark)
        if id(node) in self._seen:
            self._faults.add(mark, "syntax", "an alias of a list or mapping (make it a tree of its own, with params)")
            return Scalar(None, mark)
        self._seen.add(id(node))
        if isinstance(node, SequenceNode):
            return Items(tuple(self.read(item, depth + 1) for item in node.value), mark)
        return self._table(node, mark, depth)

    def _table(self, node: MappingNode, mark: Mark, depth: int) -> Table:
        entries: dict[str, Element] = {}
        keys: dict[str, Mark] = {}
        for key_node, value_node in node.value:
            key_mark = self._mark(key_node)
            key = self._key(key_node, key_mark)
            if key in entries:
                self._faults.add(key_mark, "duplicate-key", f"'{key}' is already given in line {keys[key].line}")
                continue
            entries[key], keys[key] = self.read(value_node, depth + 1), key_mark
        return Table(entries, keys, mark)

    def _key(self, node: Any, mark: Mark) -> str:
        if not isinstance(node, ScalarNode):
            self._faults.add(mark, "syntax", "a list or mapping as a key (a key is a word)")
            return f"?{mark.line}:{mark.column}"
        return str(node.value)

    def _scalar(self, node: ScalarNode, mark: Mark) -> str | int | float | bool | None:
        kind = str(node.tag or TEXT_TAGS[0]).removeprefix("tag:yaml.org,2002:")
        if kind not in ("int", "float", "bool", "null"):
            if kind not in TEXT_TAGS:
                self._faults.add(mark, "syntax", f"the tag '{kind}' means nothing here (leave it out)")
            return str(node.value)
        try:
            value = self._constructor.construct_object(node)
        except (ValueError, OverflowError, YAMLError) as error:
            self._faults.add(mark, "syntax", f"'{node.value}' is no {kind}: {error}")
            return None
        return value if isinstance(value, int | float | bool | None) else str(node.value)

    def _mark(self, node: Any) -> Mark:
        return Mark(self._name, node.start_mark.line + 1, node.start_mark.column + 1)
