"""What names stand for in one instance of a tree: constants, or keys of the blackboard."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from py_trees.blackboard import Blackboard

from zavis_bt.errors import InputError
from zavis_bt.tree.datatypes import coercer
from zavis_bt.tree.ports import MISSING

UNSET: Any = object()
"""Value of a param that is not known: the tree is only built to be checked or shown."""


@dataclass(frozen=True, slots=True)
class Constant:
    """A value that does not change."""

    value: Any

    def read(self) -> Any:
        """Return the value."""
        return self.value


@dataclass(frozen=True, slots=True)
class Variable:
    """A key of the blackboard."""

    name: str
    key: str
    type: Any = Any

    def read(self) -> Any:
        """Return the value.

        Raises:
            InputError: Nothing has been written yet.
        """
        value = Blackboard.storage.get(self.key, MISSING)
        if value is MISSING:
            raise InputError(f"${self.name} is read, but nothing has written it yet")
        return value

    def write(self, value: Any) -> None:
        """Write a value, converted to the variable's type.

        Raises:
            TypeError: The value has another type.
        """
        Blackboard.storage[self.key] = coercer(self.type)(value)

    def clear(self) -> None:
        """Forget the value."""
        Blackboard.storage.pop(self.key, None)


Binding = Constant | Variable


@dataclass(slots=True)
class Scope:
    """The names of one instance of a tree."""

    namespace: str
    """Where the instance's own variables are, on the blackboard."""
    bindings: dict[str, Binding] = field(default_factory=dict)
    own: list[Variable] = field(default_factory=list)
    """Variables that begin anew whenever the tree is started."""

    def __getitem__(self, name: str) -> Binding:
        return self.bindings[name]

    def read(self, name: str) -> Any:
        """Return the value of a name."""
        return self.bindings[name].read()

    def types(self) -> Mapping[str, Any]:
        """Return the types of the variables."""
        return {name: b.type for name, b in self.bindings.items() if isinstance(b, Variable)}
