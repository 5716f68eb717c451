"""Types of ports and variables: their names in tree files, what may flow into what, and conversion of values.

Types are Python's own: ``float``, ``list[Viewpoint]``, ``Pose2D | Viewpoint``. An int may always stand for a float.
"""

from __future__ import annotations

import ast
import inspect
import types
import typing
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from numbers import Integral, Real
from typing import Any

import numpy as np

import zavis_bt.types
from zavis_bt.errors import InputError, did_you_mean

Coercer = Callable[[Any], Any]

SCALARS: Mapping[str, type] = {"str": str, "int": int, "float": float, "bool": bool}


def type_name(type_: Any) -> str:
    """Return the type as a tree file writes it."""
    if type_ is None or type_ is types.NoneType:
        return "none"
    if type_ is Any or type_ is object:
        return "any"
    arguments = typing.get_args(type_)
    if is_union(type_):
        return " | ".join(type_name(argument) for argument in arguments)
    if typing.get_origin(type_) is typing.Literal:
        return " | ".join(map(repr, arguments))
    name = getattr(typing.get_origin(type_) or type_, "__name__", str(type_))
    inner = ", ".join("..." if argument is Ellipsis else type_name(argument) for argument in arguments)
    return f"{name}[{inner}]" if inner else name


def is_union(type_: Any) -> bool:
    """Return whether the type is ``A | B``."""
    return typing.get_origin(type_) in (typing.Union, types.UnionType)


def type_names(port_types: Iterable[Any] = ()) -> dict[str, Any]:
    """Return every type name a tree file may use.

    Args:
        port_types: Further types, those of the registered behaviours' ports; their classes are known by name too.
    """
    names: dict[str, Any] = {**SCALARS, "any": Any, "none": types.NoneType, "pose": zavis_bt.types.Pose2D}
    for name in zavis_bt.types.__all__:
        if inspect.isclass(value := getattr(zavis_bt.types, name)):
            names[name] = value
    for port_type in port_types:
        names.update({part.__name__: part for part in _classes(port_type) if part.__name__ not in names})
    return names


def _classes(type_: Any) -> list[type]:
    arguments = typing.get_args(type_)
    if arguments:
        return [part for argument in arguments for part in _classes(argument)]
    return [type_] if inspect.isclass(type_) else []


def parse_type(text: str, names: Mapping[str, Any]) -> Any:
    """Return the type that a tree file writes as ``text``.

    Raises:
        InputError: The text is no type, or names an unknown one.
    """
    try:
        expression = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"'{text}' is no type (such as float, list[str] or Pose2D | Viewpoint)") from error
    return _resolve(expression, text, names)


def _resolve(expression: ast.expr, text: str, names: Mapping[str, Any]) -> Any:
    match expression:
        case ast.Name(id=name):
            if name not in names:
                raise InputError(f"unknown type '{name}'{did_you_mean(name, names) or ' (such as float or Pose2D)'}")
            return names[name]
        case ast.Subscript(value=ast.Name(id="list"), slice=inner):
            return types.GenericAlias(list, (_resolve(inner, text, names),))
        case ast.BinOp(left=left, op=ast.BitOr(), right=right):
            return _resolve(left, text, names) | _resolve(right, text, names)
    raise InputError(f"'{text}' is no type (such as float, list[str] or Pose2D | Viewpoint)")


def assignable(source: Any, target: Any) -> bool:
    """Return whether every value of type ``source`` may go where ``target`` is expected."""
    if source in (Any, object) or target in (Any, object) or source == target:
        return True
    if typing.get_origin(source) is typing.Literal:
        return all(assignable(type(value), target) for value in typing.get_args(source))
    if is_union(source):
        return all(assignable(part, target) for part in typing.get_args(source))
    if is_union(target):
        return any(assignable(source, part) for part in typing.get_args(target))
    return _assignable_plain(source, target)


def _assignable_plain(source: Any, target: Any) -> bool:
    source_class, target_class = typing.get_origin(source) or source, typing.get_origin(target) or target
    if target_class is float and source_class is int:
        return True
    if not (inspect.isclass(source_class) and inspect.isclass(target_class)):
        return True  # a TypeVar, a Protocol's alias: nothing can be said
    if source_class is bool and target_class is int:
        return False
    sequences = (list, tuple)
    if not (issubclass(source_class, target_class) or (source_class in sequences and target_class in sequences)):
        return False
    inner = [argument for argument in typing.get_args(source) if argument is not Ellipsis]
    outer = [argument for argument in typing.get_args(target) if argument is not Ellipsis]
    return len(inner) != len(outer) or all(map(assignable, inner, outer))


@cache
def coercer(type_: Any) -> Coercer:
    """Return a function that converts a value to the type, or raises TypeError.

    Only harmless conversions are made: int to float, numpy scalars to Python's, tuple to list and back.
    """
    if type_ in (Any, object):
        return lambda value: value
    if type_ in _SCALAR_COERCERS:
        return _SCALAR_COERCERS[type_]
    if typing.get_origin(type_) is typing.Literal:
        return _literal_coercer(typing.get_args(type_))
    if is_union(type_):
        return _union_coercer([coercer(part) for part in typing.get_args(type_)], type_)
    origin, arguments = typing.get_origin(type_), typing.get_args(type_)
    if origin in (list, tuple) and len(set(arguments) - {Ellipsis}) == 1:
        return _sequence_coercer(origin, coercer(arguments[0]), type_)
    return _instance_coercer(origin or type_)


def _float(value: Any) -> float:
    if isinstance(value, float):
        return value
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"takes float, not {describe(value)}")
    return float(value)


def _int(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise TypeError(f"takes int, not {describe(value)}")
    return int(value)


def _bool(value: Any) -> bool:
    if isinstance(value, bool | np.bool_):
        return bool(value)
    raise TypeError(f"takes bool, not {describe(value)}")


_SCALAR_COERCERS: Mapping[Any, Coercer] = {float: _float, int: _int, bool: _bool}


def _union_coercer(parts: list[Coercer], type_: Any) -> Coercer:
    def coerce(value: Any) -> Any:
        results = []
        for part in parts:
            try:
                result = part(value)
            except TypeError:
                continue
            if result is value:  # the exact member goes before a converting one
                return value
            results.append(result)
        if results:
            return results[0]
        raise TypeError(f"takes {type_name(type_)}, not {describe(value)}")

    return coerce


def _literal_coercer(values: tuple[Any, ...]) -> Coercer:
    def coerce(value: Any) -> Any:
        if value in values:
            return value
        raise TypeError(f"takes {' | '.join(map(repr, values))}, not {describe(value)}")

    return coerce


def _sequence_coercer(origin: type, item: Coercer, type_: Any) -> Coercer:
    def coerce(value: Any) -> Any:
        if not isinstance(value, list | tuple):
            raise TypeError(f"takes {type_name(type_)}, not {describe(value)}")
        return origin(item(part) for part in value)

    return coerce


def _instance_coercer(class_: Any) -> Coercer:
    try:
        isinstance(None, class_)
    except TypeError:  # a Protocol that is not checkable at run time, a TypeVar: nothing can be said
        return lambda value: value

    def coerce(value: Any) -> Any:
        if isinstance(value, class_):
            return value
        raise TypeError(f"takes {type_name(class_)}, not {describe(value)}")

    return coerce


def describe(value: Any) -> str:
    """Return a value for a message: itself if it is short, otherwise its type."""
    text = repr(value) if isinstance(value, str | int | float | bool | None | list | dict) else ""
    return text if text and len(text) <= 40 else f"a {type(value).__name__}"
