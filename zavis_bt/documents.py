"""YAML files as plain data that remembers its lines, and models checked against it.

One pass of the parser gives values and line numbers at once, so that every fault can name its line. Scalars follow
YAML 1.2's core schema: ``on`` is text, not true.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from zavis_bt.errors import InputError, did_you_mean

Keys = tuple[str | int, ...]
Model = TypeVar("Model", bound=BaseModel)

_INT = re.compile(r"[-+]?[0-9]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_WORDS: Mapping[str, object] = {
    "": None, "~": None, "null": None, "Null": None, "NULL": None,
    "true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False,
    ".nan": float("nan"), ".inf": float("inf"), "-.inf": -float("inf"),
}  # fmt: skip


_WORDING: Mapping[str, str] = {
    "tuple_type": "should be a list",
    "list_type": "should be a list",
    "float_parsing": "should be a number",
}  # where pydantic speaks of Python


@dataclass(frozen=True, slots=True)
class Document:
    """Content of a YAML file: mappings, lists and scalars."""

    path: Path
    data: Any
    lines: Mapping[Keys, int]
    """Line, counted from 1, of the value at these keys."""

    def where(self, *keys: str | int) -> str:
        """Return ``file:line`` of the value at these keys, or of the closest value around it."""
        while keys and keys not in self.lines:
            keys = keys[:-1]
        return f"{self.path}:{self.lines.get(keys, 1)}"


def read_document(path: Path) -> Document:
    """Read a YAML file.

    Raises:
        InputError: The file cannot be read or is not YAML; a key occurs twice.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    lines: dict[Keys, int] = {}
    try:
        events = iter(YAML(typ="safe", pure=True).parse(path.read_text(encoding="utf-8")))
        data = _Builder(path, events, lines).document()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not UTF-8 text") from error
    except MarkedYAMLError as error:
        line = f":{error.problem_mark.line + 1}" if error.problem_mark else ""
        raise InputError(f"{path}{line}: is not YAML: {error.problem or error.context}") from error
    except YAMLError as error:
        raise InputError(f"{path}: is not YAML: {' '.join(str(error).split())}") from error
    return Document(path, data, lines)


class _Builder:
    """Turns the parser's events into values and notes their lines."""

    def __init__(self, path: Path, events: Iterator[Any], lines: dict[Keys, int]) -> None:
        self._path, self._events, self._lines = path, events, lines
        self._anchors: dict[str, object] = {}

    def document(self) -> object:
        for event in self._events:
            if type(event).__name__ not in ("StreamStartEvent", "DocumentStartEvent", "CommentEvent"):
                return None if type(event).__name__ == "StreamEndEvent" else self._value(event, ())
        return None

    def _value(self, event: Any, keys: Keys) -> object:
        kind = type(event).__name__
        self._lines[keys] = event.start_mark.line + 1
        if kind == "AliasEvent":
            if event.anchor not in self._anchors:
                raise InputError(f"{self._path}:{self._lines[keys]}: unknown anchor '{event.anchor}'")
            return self._anchors[event.anchor]
        build = {"MappingStartEvent": self._mapping, "SequenceStartEvent": self._list}.get(kind)
        value = build(keys) if build else _scalar(event)
        if event.anchor:
            self._anchors[event.anchor] = value
        return value

    def _mapping(self, keys: Keys) -> object:
        mapping: dict[str, object] = {}
        for event in self._events:
            if type(event).__name__ == "MappingEndEvent":
                break
            line = event.start_mark.line + 1
            key = getattr(event, "value", None)
            if key is None or key in mapping:
                fault = "a key must be a word" if key is None else f"key '{key}' occurs twice"
                raise InputError(f"{self._path}:{line}: {fault}")
            mapping[key] = self._value(next(self._events), (*keys, key))
            self._lines[(*keys, key)] = line
        return mapping

    def _list(self, keys: Keys) -> object:
        items: list[object] = []
        for event in self._events:
            if type(event).__name__ == "SequenceEndEvent":
                break
            items.append(self._value(event, (*keys, len(items))))
        return items


def _scalar(event: Any) -> object:
    text: str = event.value
    if event.style is not None:
        return text
    if text in _WORDS:
        return _WORDS[text]
    if _INT.fullmatch(text):
        return int(text)
    return float(text) if _FLOAT.fullmatch(text) else text


def check(document: Document, model: type[Model]) -> tuple[Model | None, list[str]]:
    """Check a document against a pydantic model.

    Args:
        document: What was read.
        model: What it should be; with ``extra="forbid"`` unknown keys are faults.

    Returns:
        The checked model, or None; and the faults, one line each with file, line and keys.
    """
    if not isinstance(document.data, dict):
        return None, [f"{document.where()}: should hold keys and values ({', '.join(model.model_fields)})"]
    try:
        return model.model_validate(document.data), []
    except ValidationError as error:
        # An unknown key comes first: it is often the cause of a missing one.
        faults = sorted(error.errors(), key=lambda fault: fault["type"] != "extra_forbidden")
        return None, [f"{document.where(*fault['loc'])}: {explain(dict(fault), model)}" for fault in faults]


def explain(fault: Mapping[str, Any], model: type[BaseModel]) -> str:
    """Return a pydantic error as ``keys: what is wrong (what would be right)``."""
    *parents, last = fault["loc"] or ("",)
    if fault["type"] == "extra_forbidden":
        return f"unknown key '{_joined(fault['loc'])}'{did_you_mean(str(last), _fields_at(model, parents))}"
    if fault["type"] == "missing":
        return f"key '{_joined(fault['loc'])}' is missing"
    message = _WORDING.get(fault["type"], fault["msg"].removeprefix("Value error, ").removeprefix("Input "))
    if fault["type"] == "value_error" or isinstance(fault["input"], dict | list):
        return f"{_joined(fault['loc'])}: {message}".removeprefix(": ")
    return f"{_joined(fault['loc'])}: {message}, not {fault['input']!r}"


def _joined(keys: Keys) -> str:
    return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in keys).removeprefix(".")


def _fields_at(model: type[BaseModel], keys: list[str | int]) -> list[str]:
    """Return the names of the fields of the model that lies at these keys of a model."""
    for key in keys:
        field = model.model_fields.get(str(key))
        if field is not None:
            model = next(_models_in(field.annotation), model)
    return [field.alias or name for name, field in model.model_fields.items()]


def _models_in(annotation: object) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _models_in(argument)
