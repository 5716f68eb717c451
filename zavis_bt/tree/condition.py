"""Comparisons in ``when``: a small language of its own, so that a tree file can never run code."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from zavis_bt.errors import InputError
from zavis_bt.tree.datatypes import assignable, type_name

Read = Callable[[str], Any]
Evaluate = Callable[[Read], Any]

_TOKEN = re.compile(r"\"[^\"]*\"|'[^']*'|\$([A-Za-z_]\w*)")
_PREFIX = "variable_"
_CONSTANTS: Mapping[str, Any] = {"true": True, "false": False, "null": None}
_ORDERING: Mapping[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_OPERATORS: Mapping[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    **_ORDERING,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.In: lambda left, right: left in right,
    ast.NotIn: lambda left, right: left not in right,
}
HINT = "(such as $battery > 0.3, $found != null, len($items) == 0, joined by and, or, not)"


@dataclass(frozen=True, slots=True)
class Condition:
    """A comparison that was understood."""

    text: str
    names: tuple[str, ...]
    """Variables it reads."""
    tree: ast.expr

    def compile(self) -> Evaluate:
        """Return a function that evaluates it, given one that reads variables."""
        return _compile(self.tree)

    def type_faults(self, types: Mapping[str, Any]) -> list[str]:
        """Return what cannot be compared, knowing the variables' types."""
        found: list[str] = []
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Compare):
                operands = [node.left, *node.comparators]
                for op, left, right in zip(node.ops, operands, operands[1:], strict=False):
                    a, b = _type(left, types), _type(right, types)
                    if not _comparable(op, a, b):
                        found.append(f"'{self.text}' compares {type_name(a)} with {type_name(b)}")
        return found


def parse_condition(text: str) -> Condition:
    """Return the comparison that a text describes.

    Raises:
        InputError: It is none, or uses what is not allowed.
    """
    names: list[str] = []

    def replace(match: re.Match[str]) -> str:
        if match[1] is None:
            return match[0]
        names.append(match[1])
        return _PREFIX + match[1]

    try:
        tree = ast.parse(_TOKEN.sub(replace, text).strip(), mode="eval").body
        _compile(tree)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"'{text}' is no comparison {HINT}") from error
    return Condition(text, tuple(dict.fromkeys(names)), tree)


def _compile(node: ast.expr) -> Evaluate:
    """Return a function for a whitelisted expression, or raise ValueError."""
    match node:
        case ast.BoolOp(op=op, values=values):
            parts = [_compile(value) for value in values]
            fold = all if isinstance(op, ast.And) else any
            return lambda read: fold(part(read) for part in parts)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            inner = _compile(operand)
            return lambda read: not inner(read)
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() | float() as number)):
            return _constant(-number)
        case ast.Compare(left=left, ops=ops, comparators=comparators):
            return _chain([_compile(left), *map(_compile, comparators)], [_operator(op) for op in ops])
        case ast.Constant(value=None | str() | int() | float() as value):
            return _constant(value)
        case ast.Name(id=name) if name.startswith(_PREFIX):
            return _variable(name.removeprefix(_PREFIX))
        case ast.Name(id=name) if name in _CONSTANTS:
            return _constant(_CONSTANTS[name])
        case ast.List(elts=items) | ast.Tuple(elts=items):
            parts = [_compile(item) for item in items]
            return lambda read: [part(read) for part in parts]
        case ast.Call(func=ast.Name(id="len"), args=[argument], keywords=[]):
            inner = _compile(argument)
            return lambda read: len(inner(read))
    raise ValueError("not allowed")


def _constant(value: Any) -> Evaluate:
    return lambda read: value


def _variable(name: str) -> Evaluate:
    return lambda read: read(name)


def _operator(op: ast.cmpop) -> Callable[[Any, Any], Any]:
    if type(op) not in _OPERATORS:
        raise ValueError("not allowed")
    return _OPERATORS[type(op)]


def _chain(operands: list[Evaluate], operators: list[Callable[[Any, Any], Any]]) -> Evaluate:
    def evaluate(read: Read) -> bool:
        values = [operand(read) for operand in operands]
        return all(op(a, b) for op, a, b in zip(operators, values, values[1:], strict=False))

    return evaluate


def _type(node: ast.expr, types: Mapping[str, Any]) -> Any:
    match node:
        case ast.Name(id=name) if name.startswith(_PREFIX):
            return types.get(name[len(_PREFIX) :], Any)
        case ast.Name(id=name) if name in _CONSTANTS:
            return type(_CONSTANTS[name])
        case ast.Constant(value=value):
            return type(value)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return _type(operand, types)
        case ast.Call():
            return int
    return Any


def _comparable(op: ast.cmpop, left: Any, right: Any) -> bool:
    if Any in (left, right) or isinstance(op, ast.In | ast.NotIn):
        return True
    if type(op) in _ORDERING:
        return any(assignable(left, one) and assignable(right, one) for one in (float, str))
    return type(None) in (left, right) or assignable(left, right) or assignable(right, left)
