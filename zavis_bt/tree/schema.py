"""JSON Schema of tree files, for completion and first hints in editors; the loader's checks are the truth.

A node is one flat object whose properties are every kind and every modifier. That a node has exactly one kind is
left to the loader, since editors mishandle the ways to say it.
"""

from __future__ import annotations

import dataclasses
import inspect
import typing
from collections.abc import Iterable, Mapping
from typing import Any

from zavis_bt.tree.controls import CONTROLS, LEAF_SHORTHAND, SET, SET_DOC, Control
from zavis_bt.tree.datatypes import is_union, type_name
from zavis_bt.tree.declarations import FIELDS
from zavis_bt.tree.includes import FORMAT
from zavis_bt.tree.ports import Port
from zavis_bt.tree.spec import Signature

Schema = dict[str, Any]

_NODE: Schema = {"$ref": "#/$defs/node"}
_NODES: Schema = {"type": "array", "items": _NODE, "minItems": 1}
_REFERENCE: Schema = {"type": "string", "pattern": r"^\$[A-Za-z_][A-Za-z0-9_]*$"}
_SCALARS: Mapping[Any, str] = {str: "string", int: "integer", float: "number", bool: "boolean", type(None): "null"}


def file_schema(signatures: Iterable[Signature]) -> Schema:
    """Return the schema of a tree file.

    Args:
        signatures: Behaviours, and trees that may be called.
    """
    kinds = {signature.kind: signature for signature in signatures}
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Mission tree",
        "type": "object",
        "required": ["bt", "trees"],
        "additionalProperties": False,
        "properties": {
            "bt": {"const": FORMAT, "description": "Version of the format"},
            "include": {"type": "array", "items": {"type": "string"}, "description": "Files whose trees become kinds"},
            "root": {"type": "string", "description": "Tree to run"},
            "globals": _declarations("Variables of every tree"),
            "trees": {"type": "object", "minProperties": 1, "additionalProperties": {"$ref": "#/$defs/tree"}},
        },
        "$defs": {
            "tree": _tree(),
            "declaration": _declaration(),
            "node": {"anyOf": [{"type": "string", "enum": sorted(kinds)}, {"$ref": "#/$defs/mapping"}]},
            "mapping": _mapping(kinds),
        },
    }


def _declarations(text: str) -> Schema:
    return {"type": "object", "additionalProperties": {"$ref": "#/$defs/declaration"}, "description": text}


def _tree() -> Schema:
    return {
        "type": "object",
        "required": ["do"],
        "additionalProperties": False,
        "properties": {
            "doc": {"type": "string", "description": "What the tree does"},
            "params": _declarations("Constants, known when the tree is loaded"),
            "in": _declarations("Values that come in at run time"),
            "out": _declarations("Values that go out at run time"),
            "do": _NODE,
        },
    }


def _declaration() -> Schema:
    texts: Schema = {key: {"type": "string"} for key in ("type", "doc", "unit")}
    numbers: Schema = {key: {"type": "number"} for key in ("ge", "le", "gt", "lt")}
    properties = {**{key: {} for key in FIELDS}, **texts, **numbers, "choices": {"type": "array"}}
    table = {"type": "object", "required": ["type"], "additionalProperties": False, "properties": properties}
    return {"anyOf": [{"type": "string"}, table]}


def _mapping(kinds: Mapping[str, Signature]) -> Schema:
    properties: Schema = {kind: _leaf(signature) for kind, signature in sorted(kinds.items())}
    properties.update({kind: _control(control) for kind, control in CONTROLS.items()})
    properties[SET] = {"type": "object", "description": SET_DOC}
    properties["name"] = {"type": "string", "description": "Shown instead of the kind"}
    properties["save"] = {
        "type": "object",
        "additionalProperties": {"type": "string"},
        "description": "Output port to variable of this tree",
    }
    properties["do"] = {**_NODE, "description": "Block of the kind beside it"}
    properties["recover"] = {**_NODE, "description": "Runs between the attempts of retry"}
    return {"type": "object", "additionalProperties": False, "minProperties": 1, "properties": properties}


def _leaf(signature: Signature) -> Schema:
    table: Schema = {
        "type": ["object", "null"],
        "additionalProperties": False,
        "properties": {name: _port(port, name in signature.constants) for name, port in signature.inputs.items()},
    }
    required = [name for name, port in signature.inputs.items() if port.required]
    if required:
        table = {**table, "type": "object", "required": required}
    doc = inspect.cleandoc(signature.doc) if signature.doc else signature.kind
    shorthand = LEAF_SHORTHAND.get(signature.kind)
    if shorthand:
        return {"anyOf": [_port(signature.inputs[shorthand]), table], "description": doc}
    return {**table, "description": doc}


def _control(control: Control) -> Schema:
    slots: Schema = {slot.name: _NODES if slot.many else _NODE for slot in control.slots}
    properties = {**{name: _port(port) for name, port in control.inputs.items()}, **slots}
    table: Schema = {"type": "object", "additionalProperties": False, "properties": properties}
    slot = control.slot(control.shorthand)
    forms: list[Schema] = [_NODES] if slot and slot.many else [_NODE] if slot else []
    if control.shorthand in control.inputs:
        forms = [_port(control.inputs[control.shorthand])]
    return {"anyOf": [*forms, table], "description": control.doc} if forms else {**table, "description": control.doc}


def _port(port: Port, constant: bool = False) -> Schema:
    words = [port.description, f"[{port.unit}]" if port.unit else "", f"({type_name(port.data_type)})"]
    schema: Schema = {"description": " ".join(word for word in words if word)}
    value = _value(port.data_type, port)
    if port.optional and port.default_value is not None and isinstance(port.default_value, str | int | float | bool):
        schema["default"] = port.default_value
    return {**schema, "anyOf": [value, _REFERENCE]} if value else schema


def _value(type_: Any, port: Port | None = None) -> Schema:
    """Return the schema of a type's values, empty if anything goes."""
    if port is not None and port.choices:
        return {"enum": list(port.choices)}
    if type_ in _SCALARS:
        names = {"ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum"}
        limits = {word: getattr(port, name) for name, word in names.items() if getattr(port, name, None) is not None}
        return {"type": _SCALARS[type_], **limits}
    if typing.get_origin(type_) is typing.Literal:
        return {"enum": list(typing.get_args(type_))}
    if is_union(type_):
        parts = [_value(part, port) for part in typing.get_args(type_)]
        return {"anyOf": parts} if all(parts) else {}
    if typing.get_origin(type_) is list:
        return {"type": "array", "items": _value(typing.get_args(type_)[0])}
    if dataclasses.is_dataclass(type_):
        properties: Schema = {field.name: {} for field in dataclasses.fields(type_)}
        table = {"type": "object", "additionalProperties": False, "properties": properties}
        return {"anyOf": [table, {"type": "array", "maxItems": len(properties)}]}
    return {}
