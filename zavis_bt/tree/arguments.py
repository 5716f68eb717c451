"""Values written in a tree file against the ports they are for: pydantic validates, the message says where and what."""

from __future__ import annotations

import dataclasses
import functools
import inspect
import operator
import typing
from types import NoneType
from typing import Annotated, Any

from zavis_bt.tree.datatypes import describe, is_union, type_name
from zavis_bt.tree.document import Element, Items, Table
from zavis_bt.tree.faults import Mark
from zavis_bt.tree.ports import Port

if typing.TYPE_CHECKING:
    from pydantic import TypeAdapter

Found = tuple[Mark, str, str]
"""Place, code and message of a fault."""

_RANGE_ERRORS = ("greater_than_equal", "greater_than", "less_than_equal", "less_than")


def value_fault(port: Port, name: str, element: Element, plain: Any = ...) -> tuple[Any, Found | None]:
    """Return the value of a port as Python has it, and what is wrong with it.

    Args:
        port: What the value is for.
        name: The port's name, for the message.
        element: The value as written.
        plain: The value, if it is not what is written.
    """
    from pydantic import ValidationError

    value = element.plain if plain is ... else plain
    if value is None and port.optional:
        return None, None
    checker = adapter(port.data_type)
    if checker is None:
        kind = type_name(port.data_type)
        return None, (element.mark, "type", f"'{name}' takes {kind}, which cannot be written here (give a $variable)")
    try:
        converted = checker.validate_python(value)
    except ValidationError as error:
        return None, _type_fault(port, name, element, error)
    if fault := port.range_fault(converted):
        return None, (element.mark, "range", f"'{name}' {fault}")
    return converted, None


def _type_fault(port: Port, name: str, element: Element, error: Any) -> Found:
    first = error.errors(include_url=False)[0]
    place = element
    path: list[str] = []
    for step in first["loc"]:
        if isinstance(place, Items) and isinstance(step, int) and step < len(place.items):
            place, path = place.items[step], [*path, f"[{step}]"]
        elif isinstance(place, Table) and step in place.entries:
            place, path = place.entries[str(step)], [*path, f".{step}"]
    where = f"'{name}{''.join(path)}'"
    if path and first["type"] not in ("missing", "unexpected_keyword_argument"):
        return place.mark, "type", f"{where} {_lower(first['msg'])}, not {describe(place.plain)}"
    detail = f": {_lower(first['msg'])} '{first['loc'][-1]}'" if first["loc"] and first["type"] == "missing" else ""
    return place.mark, "type", f"{where} takes {type_name(port.data_type)}, not {describe(place.plain)}{detail}"


def _lower(text: str) -> str:
    return text[:1].lower() + text[1:]


@functools.lru_cache(maxsize=512)
def adapter(type_: Any) -> TypeAdapter[Any] | None:
    """Return pydantic's validator for the type, or None if no value of it can be written in YAML."""
    from pydantic import TypeAdapter
    from pydantic.errors import PydanticUserError

    try:
        return TypeAdapter(_strict(type_))
    except PydanticUserError:  # arrays and the like: there is no way to write one
        return None


def _strict(type_: Any) -> Any:
    """Return the type so annotated that a text is no number, and a list of numbers may stand for a dataclass."""
    from pydantic import BeforeValidator, Strict

    if type_ in (str, int, float, bool):
        return Annotated[type_, Strict()]
    if type_ in (Any, object, NoneType):
        return type_
    if is_union(type_):
        return functools.reduce(operator.or_, (_strict(part) for part in typing.get_args(type_)))
    if typing.get_origin(type_) in (list, tuple):
        return typing.get_origin(type_)[tuple(p if p is ... else _strict(p) for p in typing.get_args(type_))]
    if dataclasses.is_dataclass(type_) and inspect.isclass(type_):
        return Annotated[type_, BeforeValidator(lambda value: _by_name(value, type_))]
    return type_


def _by_name(value: Any, type_: Any) -> Any:
    """Return ``[1, 2, 0.5]`` as ``{x: 1, y: 2, yaw: 0.5}``, inside dataclasses too; anything else as it is."""
    if not (inspect.isclass(type_) and dataclasses.is_dataclass(type_) and isinstance(value, list | dict)):
        return value
    types = {field.name: _hints(type_)[field.name] for field in dataclasses.fields(type_)}
    if isinstance(value, list):
        if len(value) > len(types):
            return value
        value = dict(zip(types, value, strict=False))
    return {name: _by_name(part, types.get(name)) for name, part in value.items()}


@functools.lru_cache(maxsize=128)
def _hints(type_: Any) -> dict[str, Any]:
    return typing.get_type_hints(type_)
