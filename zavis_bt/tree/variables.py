"""What ``$name`` can mean inside a tree, and of which type it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import GenericAlias
from typing import Any, Literal, get_args, get_origin

from zavis_bt.tree.controls import SET
from zavis_bt.tree.datatypes import assignable, type_name
from zavis_bt.tree.faults import Mark
from zavis_bt.tree.includes import Library
from zavis_bt.tree.spec import Argument, Declared, NodeSpec, Reference, TreeSpec

Role = Literal["param", "in", "out", "global", "variable", "item"]


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name of a tree."""

    name: str
    role: Role
    type: Any
    mark: Mark
    unit: str = ""

    @property
    def text(self) -> str:
        """Its type and unit in words."""
        return type_name(self.type) + (f" [{self.unit}]" if self.unit else "")


def symbols_of(tree: TreeSpec, library: Library) -> dict[str, Symbol]:
    """Return every name of a tree; what is written with types that do not fit together is a fault."""
    symbols: dict[str, Symbol] = {}
    blocks: tuple[tuple[Role, Mapping[str, Declared]], ...] = (
        ("global", library.globals),
        ("param", tree.params),
        ("in", tree.inputs),
        ("out", tree.outputs),
    )
    for role, block in blocks:
        for name, declared in block.items():
            if name in symbols and symbols[name].role == "global":
                library.faults.add(declared.mark, "name", f"'{name}' is the name of a global (choose another)")
            port = declared.port
            symbols[name] = Symbol(name, role, port.value_type, declared.mark, port.unit)
    for node in tree.do.walk() if tree.do else ():
        _collect(node, symbols, tree, library)
    return symbols


def _collect(node: NodeSpec, symbols: dict[str, Symbol], tree: TreeSpec, library: Library) -> None:
    signature = library.signature(node.kind, tree.file)
    for port_name, argument in node.save.items():
        port = signature.outputs.get(port_name) if signature else None
        type_, unit = (port.data_type, port.unit) if port else (Any, "")  # what is unknown is reported elsewhere
        _write(str(argument.value), type_, unit, argument.mark, symbols, library)
    if node.kind == SET:
        for name, argument in node.arguments.items():
            _write(name, type_of(argument, symbols), "", argument.key, symbols, library)
    if node.kind == "for_each":
        _collect_item(node, symbols, library)


def _collect_item(node: NodeSpec, symbols: dict[str, Symbol], library: Library) -> None:
    name, items = node.arguments.get("as"), node.arguments.get("items")
    if name is None or not isinstance(name.value, str):
        return
    type_ = element_type(type_of(items, symbols)) if items else Any
    known = symbols.get(name.value)
    if known is not None and known.role != "item":
        library.faults.add(name.mark, "name", f"'{name.value}' is already a {known.role} of this tree (choose another)")
    elif known is not None and not (assignable(type_, known.type) or assignable(known.type, type_)):
        what = f"'{name.value}' is {known.text} in line {known.mark.line} and {type_name(type_)} here"
        library.faults.add(name.mark, "type", f"{what} (use two names)")
    else:
        symbols[name.value] = Symbol(name.value, "item", type_, name.mark)


def _write(name: str, type_: Any, unit: str, mark: Mark, symbols: dict[str, Symbol], library: Library) -> None:
    known = symbols.get(name)
    if known is None:
        symbols[name] = Symbol(name, "variable", type_, mark, unit)
    elif known.role in ("param", "in", "item"):
        what = {"param": "a param", "in": "an input", "item": "the item of a loop"}[known.role]
        library.faults.add(mark, "name", f"'{name}' is {what}, which cannot be written (choose another name)")
    elif known.unit and unit and known.unit != unit:
        library.faults.add(mark, "type", f"'{name}' is in {known.unit} (line {known.mark.line}) and in {unit} here")
    elif assignable(type_, known.type):
        return
    elif known.role == "variable" and assignable(known.type, type_):
        symbols[name] = Symbol(name, "variable", type_, known.mark, known.unit or unit)
    elif known.role == "variable" and type(None) in (type_, known.type):
        symbols[name] = Symbol(name, "variable", known.type | type_, known.mark, unit)
    else:
        where = f"is {known.text} (line {known.mark.line})"
        library.faults.add(mark, "type", f"'{name}' {where}, but {type_name(type_)} is written here")


def type_of(argument: Argument, symbols: Mapping[str, Symbol]) -> Any:
    """Return the type of what an argument says."""
    if isinstance(argument.value, Reference):
        symbol = symbols.get(argument.value.name)
        return symbol.type if symbol else Any
    return literal_type(argument.value)


def literal_type(value: Any) -> Any:
    """Return the type of a constant."""
    if isinstance(value, list):
        kinds = {literal_type(item) for item in value}
        kinds = {float} if kinds == {int, float} else kinds
        return GenericAlias(list, (kinds.pop() if len(kinds) == 1 else Any,))
    return Any if isinstance(value, dict) else type(value)


def element_type(type_: Any) -> Any:
    """Return the type of a list's items."""
    if get_origin(type_) in (list, tuple):
        return get_args(type_)[0]
    return Any
