"""Params, ports and globals as tree files declare them: ``level: {type: float, default: 0.2, le: 1.0}``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.tree.arguments import value_fault
from zavis_bt.tree.document import Element, Scalar, Table
from zavis_bt.tree.faults import Faults, Mark
from zavis_bt.tree.nodes import NAME
from zavis_bt.tree.ports import Port
from zavis_bt.tree.spec import Declared

FIELDS = ("type", "default", "doc", "unit", "ge", "le", "gt", "lt", "choices")


def read_declarations(element: Element | None, names: Mapping[str, Any], faults: Faults) -> dict[str, Declared]:
    """Return what a ``params``, ``in``, ``out`` or ``globals`` block declares.

    Args:
        element: The block: name to type, or name to a mapping with the type and more.
        names: Types by name.
        faults: Takes what is wrong.
    """
    if element is None or (isinstance(element, Scalar) and element.value is None):
        return {}
    if not isinstance(element, Table):
        faults.add(element.mark, "structure", "declarations are a mapping from names to types, such as {target: str}")
        return {}
    declared = {}
    for name, value in element.entries.items():
        mark = element.keys[name]
        if not NAME.fullmatch(name):
            faults.add(mark, "name", f"'{name}' is no name (letters, digits, underscores)")
        elif (port := _port(value, mark, names, faults)) is not None:
            declared[name] = Declared(name, port, mark)
    return declared


def _port(element: Element, mark: Mark, names: Mapping[str, Any], faults: Faults) -> Port | None:
    if isinstance(element, Scalar):
        element = Table({"type": element}, {"type": mark}, element.mark)
    if not isinstance(element, Table):
        faults.add(
            element.mark, "structure", "a declaration is a type or a mapping, such as {type: float, default: 0.2}"
        )
        return None
    for key in element:
        if key not in FIELDS:
            faults.add(
                element.keys[key], "structure", f"unknown key '{key}' in a declaration{did_you_mean(key, FIELDS)}"
            )
    type_ = _type(element, names, faults)
    if type_ is None:
        return None
    limits = _limits(element, faults)
    port = Port(type_, True, _text(element, "doc", faults), None, _text(element, "unit", faults), **limits)
    return _with_default(port, element.get("default"), limits, faults)


def _type(table: Table, names: Mapping[str, Any], faults: Faults) -> Any | None:
    element = table.get("type")
    if not isinstance(element, Scalar) or not isinstance(element.value, str):
        faults.add(element.mark if element else table.mark, "type", "a declaration needs a type, such as float")
        return None
    try:
        return type(None) if element.value == "none" else _parse(element.value, names)
    except InputError as error:
        faults.add(element.mark, "type", str(error))
        return None


def _parse(text: str, names: Mapping[str, Any]) -> Any:
    from zavis_bt.tree.datatypes import parse_type

    return parse_type(text, names)


def _text(table: Table, key: str, faults: Faults) -> str:
    element = table.get(key)
    if element is None or (isinstance(element, Scalar) and isinstance(element.value, str)):
        return str(element.plain) if element else ""
    faults.add(element.mark, "structure", f"'{key}' is a text")
    return ""


def _limits(table: Table, faults: Faults) -> dict[str, Any]:
    limits: dict[str, Any] = {}
    for key in ("ge", "le", "gt", "lt"):
        element = table.get(key)
        value = element.plain if element else None
        if isinstance(value, int | float) and not isinstance(value, bool):
            limits[key] = float(value)
        elif element is not None:
            faults.add(element.mark, "structure", f"'{key}' is a number")
    element = table.get("choices")
    if element is not None:
        if isinstance(values := element.plain, list) and values:
            limits["choices"] = tuple(values)
        else:
            faults.add(element.mark, "structure", "'choices' is a list of values")
    return limits


def _with_default(port: Port, element: Element | None, limits: dict[str, Any], faults: Faults) -> Port:
    if element is None:
        return port
    if element.plain is None:
        return Port(port.data_type, False, port.description, None, port.unit, **limits)
    value, found = value_fault(port, "default", element)
    if found:
        faults.add(*found)
        return Port(port.data_type, False, port.description, None, port.unit, **limits)
    return Port(port.data_type, False, port.description, value, port.unit, **limits)
