"""Ports of behaviours, declared as attributes: ``tolerance = In(float, "accepted distance", unit="m", default=0.3)``.

A port reads like the value it carries. Behind it is a constant of the behaviour, or a key of py_trees' blackboard that
a tree has wired it to; the blackboard's storage is read directly, which costs a tenth of a blackboard client's read.
"""

from __future__ import annotations

import copy
import operator
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from types import NoneType, UnionType
from typing import Any, Generic, Never, Protocol, TypeVar, overload

from py_trees.blackboard import Blackboard
from py_trees.ports import PortInformation

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.tree.datatypes import coercer, describe, type_name

T = TypeVar("T")

MISSING: Any = object()
"""Stands for "no value was given", where None is a value."""


Comparison = Callable[[float, float], bool]
Bound = tuple[Comparison, float, str]

_COMPARISONS: tuple[tuple[str, Comparison, str], ...] = (
    ("ge", operator.ge, "at least"),
    ("gt", operator.gt, "more than"),
    ("le", operator.le, "at most"),
    ("lt", operator.lt, "less than"),
)


class HasPorts(Protocol):
    """What a port needs of the object it belongs to."""

    constants: dict[str, Any]
    """Values of inputs that do not change."""
    wires: dict[str, str]
    """Blackboard keys of the wired ports."""
    written: dict[str, Any]
    """Latest values of the outputs."""


@dataclass(frozen=True)
class Port(PortInformation):
    """Declaration of a port: py_trees' own, with unit, range and choices."""

    unit: str = ""
    ge: float | None = None
    le: float | None = None
    gt: float | None = None
    lt: float | None = None
    choices: tuple[Any, ...] = ()

    def __post_init__(self) -> None:
        if self.default_value is not None:
            object.__setattr__(self, "default_value", self.check(self.default_value))

    @cached_property
    def bounds(self) -> tuple[Bound, ...]:
        """The limits that were given: comparison, limit, words."""
        given = ((holds, getattr(self, name), words) for name, holds, words in _COMPARISONS)
        return tuple((holds, bound, words) for holds, bound, words in given if bound is not None)

    @property
    def optional(self) -> bool:
        """Whether the port may stay without a value."""
        return not self.required

    @property
    def value_type(self) -> Any:
        """What may flow in: the declared type, and None where None is the default."""
        return self.data_type | NoneType if self.optional and not self.has_default else self.data_type

    def check(self, value: Any) -> Any:
        """Return the value converted to the port's type.

        Raises:
            TypeError: It has another type.
            ValueError: It is out of range or not among the choices.
        """
        if value is None and self.optional:
            return None
        converted = coercer(self.data_type)(value)
        if fault := self.range_fault(converted):
            raise ValueError(fault)
        return converted

    def range_fault(self, value: Any) -> str:
        """Return what is wrong with a value of the right type, or an empty text."""
        if self.choices and value not in self.choices:
            return f"is {describe(value)}{did_you_mean(str(value), map(str, self.choices))}"
        for holds, bound, words in self.bounds:
            if not _holds(holds, value, bound):
                return f"is {describe(value)}{self.suffix} ({words} {bound:g}{self.suffix})"
        return ""

    @property
    def suffix(self) -> str:
        """The unit with a space before it, or nothing."""
        return f" {self.unit}" if self.unit else ""

    @property
    def range_text(self) -> str:
        """The accepted values in words, for tables; empty if any value is."""
        if self.choices:
            return " | ".join(map(str, self.choices))
        signs = (("ge", "≥"), ("gt", ">"), ("le", "≤"), ("lt", "<"))
        parts = [f"{sign} {getattr(self, name):g}" for name, sign in signs if getattr(self, name) is not None]
        return ", ".join(parts)


def _holds(holds: Comparison, value: Any, bound: float) -> bool:
    if isinstance(value, list | tuple):
        return all(_holds(holds, item, bound) for item in value)
    return not isinstance(value, int | float) or holds(value, bound)


class In(Generic[T]):
    """An input port. Reading the attribute gives the value; it cannot be assigned."""

    @overload
    def __init__(
        self: In[T | None],
        type_: type[T],
        description: str,
        *,
        default: None,
        unit: str = "",
        ge: float | None = None,
        le: float | None = None,
        gt: float | None = None,
        lt: float | None = None,
        choices: tuple[T, ...] = (),
    ) -> None: ...

    @overload
    def __init__(
        self,
        type_: type[T],
        description: str,
        *,
        default: T = ...,
        unit: str = "",
        ge: float | None = None,
        le: float | None = None,
        gt: float | None = None,
        lt: float | None = None,
        choices: tuple[T, ...] = (),
    ) -> None: ...

    @overload
    def __init__(self: In[Any], type_: UnionType | object, description: str, *, default: Any = ...) -> None: ...

    def __init__(self, type_: Any, description: str, *, default: Any = MISSING, unit: str = "", **limits: Any) -> None:
        """Declare an input.

        Args:
            type_: What it carries; an int is converted where a float is declared.
            description: What it means, in which frame.
            default: Taken when the tree gives no value; None makes the input optional.
            unit: SI unit.
            limits: Range ``ge``, ``le``, ``gt``, ``lt``, or accepted values ``choices``.
        """
        value = None if default is MISSING else default
        self.port = Port(type_, default is MISSING, description, value, unit=unit, **limits)
        self._ranged = bool(limits)
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type) -> In[T]: ...

    @overload
    def __get__(self, instance: HasPorts, owner: type | None = None) -> T: ...

    def __get__(self, instance: HasPorts | None, owner: type | None = None) -> In[T] | T:
        if instance is None:
            return self
        constants = instance.constants
        if self.name in constants:
            bound: T = constants[self.name]  # checked when it was bound
            return bound
        return self._read_wire(instance)

    def _read_wire(self, instance: HasPorts) -> T:
        key = instance.wires.get(self.name)
        if key is None:
            raise InputError(f"input '{self.name}' was not given ({type_name(self.port.data_type)})")
        value = Blackboard.storage.get(key, MISSING)
        if value is MISSING:
            if self.port.required:
                variable = key.rpartition("/")[2]
                raise InputError(f"input '{self.name}' reads ${variable}, which nothing has written yet")
            default: T = copy.deepcopy(self.port.default_value)  # checked when declared
            return default
        if self._ranged:
            return self._checked(value)
        # Whoever writes checks the type and the loader that types fit, except that an int may stand for a float.
        widened: Any = float(value) if type(value) is int and self.port.data_type is float else value
        read: T = widened
        return read

    def _checked(self, value: Any) -> T:
        try:
            checked: T = self.port.check(value)
        except (TypeError, ValueError) as error:
            raise InputError(f"input '{self.name}' {error}") from error
        return checked

    def __set__(self, instance: HasPorts, value: Never) -> None:
        raise AttributeError(f"input '{self.name}' cannot be assigned (outputs can)")


class Out(Generic[T]):
    """An output port. Assigning the attribute writes it; reading gives what was written last."""

    @overload
    def __init__(self, type_: type[T], description: str, *, unit: str = "") -> None: ...

    @overload
    def __init__(self: Out[Any], type_: UnionType | object, description: str, *, unit: str = "") -> None: ...

    def __init__(self, type_: Any, description: str, *, unit: str = "") -> None:
        """Declare an output.

        Args:
            type_: What it carries; an int is converted where a float is declared.
            description: What it means, in which frame.
            unit: SI unit.
        """
        self.port = Port(type_, False, description, None, unit=unit)
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type) -> Out[T]: ...

    @overload
    def __get__(self, instance: HasPorts, owner: type | None = None) -> T: ...

    def __get__(self, instance: HasPorts | None, owner: type | None = None) -> Out[T] | T:
        if instance is None:
            return self
        if self.name not in instance.written:
            raise InputError(f"output '{self.name}' has not been written yet")
        written: T = instance.written[self.name]  # checked when it was written
        return written

    def __set__(self, instance: HasPorts, value: T) -> None:
        try:
            converted = coercer(self.port.data_type)(value)
        except TypeError as error:
            raise TypeError(f"output '{self.name}' {error}") from None
        instance.written[self.name] = converted
        key = instance.wires.get(self.name)
        if key is not None:
            Blackboard.storage[key] = converted
