"""What a mission is given from outside: the root tree's params and inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from io import StringIO
from typing import Any

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.tree.arguments import value_fault
from zavis_bt.tree.datatypes import type_name
from zavis_bt.tree.document import Element, Items, Scalar, Table
from zavis_bt.tree.faults import Faults, Mark
from zavis_bt.tree.ports import Port
from zavis_bt.tree.scope import UNSET
from zavis_bt.tree.spec import Declared, TreeSpec


@dataclass(frozen=True, slots=True)
class TreeInput:
    """A param or input of a mission tree."""

    name: str
    port: Port

    @property
    def type(self) -> Any:
        """Python's type."""
        return self.port.data_type

    @property
    def type_name(self) -> str:
        """The type as tree files write it."""
        return type_name(self.port.data_type)

    @property
    def default(self) -> Any:
        """Value if none is given; None also where it is required."""
        return self.port.default_value

    @property
    def required(self) -> bool:
        """Whether a mission must give it."""
        return self.port.required

    @property
    def doc(self) -> str:
        """What it means."""
        return self.port.description

    def parse(self, text: str) -> Any:
        """Return the value that a command line's text means: YAML, a list also as ``a, b``, a text as it is.

        Raises:
            InputError: The text is no value of this input.
        """
        value: Any = text if self.type is str else _yaml(text)
        if self.type_name.startswith("list[") and not isinstance(value, list):
            items = [part.strip() for part in text.split(",") if part.strip()]
            value = items if self.type_name == "list[str]" else [_yaml(item) for item in items]
        elif self.type_name == "Pose2D" and isinstance(value, str):
            value = [_yaml(part) for part in value.split(",")]
        checked, found = value_fault(self.port, self.name, _element(value, Mark("", 1, 1)), value)
        if found:
            raise InputError(f"{self.name}={text}: {found[2]}")
        return checked


def parse_input(wanted: TreeInput, text: str) -> Any:
    """Return the value that a command line's ``name=text`` means, see `TreeInput.parse`."""
    return wanted.parse(text)


def _yaml(text: str) -> Any:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        return YAML(typ="safe", pure=True).load(StringIO(text))
    except YAMLError:
        return text


def _element(value: Any, mark: Mark) -> Element:
    """Return plain data as elements of one place, for messages about values that no file has."""
    if isinstance(value, list | tuple):
        return Items(tuple(_element(item, mark) for item in value), mark)
    if isinstance(value, Mapping):
        entries = {str(key): _element(item, mark) for key, item in value.items()}
        return Table(entries, dict.fromkeys(entries, mark), mark)
    return Scalar(value, mark)


def inputs_of(tree: TreeSpec) -> tuple[TreeInput, ...]:
    """Return what a tree takes when it is the root."""
    return tuple(TreeInput(name, declared.port) for name, declared in (tree.params | tree.inputs).items())


def root_values(tree: TreeSpec, inputs: Mapping[str, Any] | None, faults: Faults) -> dict[str, Any]:
    """Return the values of the root's params and inputs.

    Args:
        tree: The root tree.
        inputs: What the mission gives; None if the tree is only built to be checked or shown.
        faults: Takes unknown and missing inputs and wrong values.
    """
    wanted = tree.params | tree.inputs
    for name in inputs or ():
        if name not in wanted:
            near = did_you_mean(name, wanted) if wanted else " (it takes none)"
            faults.add(tree.mark, "input", f"tree '{tree.name}' has no input '{name}'{near}")
    return {name: _value(declared, inputs, tree, faults) for name, declared in wanted.items()}


def _value(declared: Declared, inputs: Mapping[str, Any] | None, tree: TreeSpec, faults: Faults) -> Any:
    port, name = declared.port, declared.name
    if inputs is not None and name in inputs:
        return _checked(declared, inputs[name], faults)
    if not port.required:
        return port.default_value
    if inputs is not None:
        what = f"tree '{tree.name}' needs the input '{name}' ({type_name(port.data_type)})"
        faults.add(declared.mark, "input", what)
    return UNSET


def _checked(declared: Declared, given: Any, faults: Faults) -> Any:
    try:
        return declared.port.check(given)
    except TypeError:  # plain data, such as [1.0, 2.0] for a pose
        value, found = value_fault(declared.port, declared.name, _element(given, declared.mark), given)
        if found:
            faults.add(declared.mark, "input", found[2])
        return UNSET if found else value
    except ValueError as error:
        faults.add(declared.mark, "input", f"'{declared.name}' {error}")
        return UNSET
