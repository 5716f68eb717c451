"""What a tree file says, independent of YAML: files, trees, nodes, arguments."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from zavis_bt.tree.document import Element
from zavis_bt.tree.faults import Mark
from zavis_bt.tree.ports import Port


@dataclass(frozen=True, slots=True)
class Reference:
    """``$name``: the value of a param, a port or a variable."""

    name: str

    def __str__(self) -> str:
        return f"${self.name}"


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a node as written."""

    value: Any
    """Plain data, or a `Reference`."""
    element: Element
    """The same with places."""
    key: Mark
    """Place of the argument's name."""

    @property
    def mark(self) -> Mark:
        """Place of the value."""
        return self.element.mark


@dataclass(frozen=True, slots=True)
class NodeSpec:
    """A node: a kind, its arguments and its children by slot. Modifiers have become nodes around it."""

    kind: str
    id: str
    """Path in the file, beginning with the tree's name."""
    mark: Mark
    name: str = ""
    arguments: Mapping[str, Argument] = field(default_factory=dict)
    children: Mapping[str, tuple[NodeSpec, ...]] = field(default_factory=dict)
    save: Mapping[str, Argument] = field(default_factory=dict)
    """Output port to the name of the variable."""

    def walk(self) -> Iterator[NodeSpec]:
        """Yield this node and all below it, depth first."""
        yield self
        for nodes in self.children.values():
            for node in nodes:
                yield from node.walk()


@dataclass(frozen=True, slots=True)
class Declared:
    """A param, port or global as a file declares it."""

    name: str
    port: Port
    mark: Mark


@dataclass(slots=True)
class TreeSpec:
    """A tree: its interface and its root node."""

    name: str
    """As callers of the file that holds it see it, e.g. ``dock``."""
    title: str
    """As ids show it, e.g. ``safety.dock``."""
    file: FileSpec
    mark: Mark
    doc: str = ""
    params: dict[str, Declared] = field(default_factory=dict)
    inputs: dict[str, Declared] = field(default_factory=dict)
    outputs: dict[str, Declared] = field(default_factory=dict)
    do: NodeSpec | None = None


@dataclass(slots=True)
class FileSpec:
    """A tree file."""

    path: Path
    name: str
    """As messages show it."""
    mark: Mark
    root: str = ""
    root_mark: Mark | None = None
    globals: dict[str, Declared] = field(default_factory=dict)
    trees: dict[str, TreeSpec] = field(default_factory=dict)
    """The file's own trees."""
    scope: dict[str, TreeSpec] = field(default_factory=dict)
    """Every tree that nodes of this file may call, by the name they call it."""


@dataclass(frozen=True, slots=True)
class Signature:
    """What a kind takes and gives, whatever it is."""

    kind: str
    doc: str
    inputs: Mapping[str, Port]
    outputs: Mapping[str, Port]
    constants: frozenset[str] = frozenset()
    """Inputs that must be known when the tree is loaded."""
