"""The schema for editors: flat, and in agreement with the loader on good files."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest
from ruamel.yaml import YAML
from tree_kinds import REGISTRY, SEARCH

from zavis_bt.tree.controls import CONTROLS, MODIFIERS
from zavis_bt.tree.leaves import LEAVES
from zavis_bt.tree.schema import file_schema
from zavis_bt.tree.spec import Signature

CLASSES = [*REGISTRY.values(), *LEAVES]
SIGNATURES = [Signature(class_.kind, class_.__doc__ or "", class_.in_ports, class_.out_ports) for class_ in CLASSES]
TREES = [Signature(name, "", {}, {}) for name in ("mission", "safety.dock", "safety.estop_clear", "visit")]
SCHEMA = file_schema(SIGNATURES)
AVOIDED = {"maxProperties", "propertyNames", "oneOf", "discriminator"}


def keywords(schema: Any) -> set[str]:
    if isinstance(schema, dict):
        return set(schema).union(*(keywords(value) for value in schema.values()))
    return set().union(*(keywords(value) for value in schema)) if isinstance(schema, list) else set()


def test_it_is_json_and_avoids_what_editors_mishandle() -> None:
    assert json.loads(json.dumps(SCHEMA)) == SCHEMA
    assert not keywords(SCHEMA) & AVOIDED


def test_a_node_is_one_flat_object_of_kinds_and_modifiers() -> None:
    node = SCHEMA["$defs"]["mapping"]
    assert node["additionalProperties"] is False
    kinds = {class_.kind for class_ in CLASSES}
    assert {*kinds, *CONTROLS, *MODIFIERS, "name", "save", "do", "recover", "set"} == set(node["properties"])


def test_ports_have_types_ranges_units_and_defaults() -> None:
    tolerance = SCHEMA["$defs"]["mapping"]["properties"]["navigate"]["properties"]["tolerance"]
    assert tolerance["anyOf"][0] == {"type": "number", "minimum": 0.05, "maximum": 2.0}
    assert tolerance["default"] == 0.3
    assert "[m]" in tolerance["description"]


def check(value: Any, schema: dict[str, Any], path: str = "") -> list[str]:
    """Return where a value breaks a schema, for the few words our schemas use."""
    if "$ref" in schema:
        return check(value, SCHEMA_WITH_TREES["$defs"][schema["$ref"].rpartition("/")[2]], path)
    if "anyOf" in schema and all(check(value, part, path) for part in schema["anyOf"]):
        return [f"{path}: {value!r} matches no form"]
    if "enum" in schema and value not in schema["enum"]:
        return [f"{path}: {value!r} is no choice"]
    names = schema.get("type", [])
    types = {"object": dict, "array": list, "string": str, "number": (int, float), "integer": int, "null": type(None)}
    if names and not any(isinstance(value, types.get(n, bool)) for n in ([names] if isinstance(names, str) else names)):
        return [f"{path}: {value!r} is no {names}"]
    if "pattern" in schema and not re.match(schema["pattern"], value):
        return [f"{path}: {value!r} does not match"]
    return _inside(value, schema, path)


def _inside(value: Any, schema: dict[str, Any], path: str) -> list[str]:
    faults = []
    if isinstance(value, list):
        for index, item in enumerate(value):
            faults += check(item, schema.get("items", {}), f"{path}[{index}]")
    if isinstance(value, dict):
        faults += [f"{path}: no {key}" for key in schema.get("required", []) if key not in value]
        extra = schema.get("additionalProperties", {})
        for key, item in value.items():
            inner = schema.get("properties", {}).get(key, extra)
            faults += [f"{path}: unknown {key}"] if inner is False else check(item, inner or {}, f"{path}.{key}")
    return faults


SCHEMA_WITH_TREES = file_schema([*SIGNATURES, *TREES])
OPEN = {"mission", "safety.dock", "visit"}
for _kind in OPEN:
    SCHEMA_WITH_TREES["$defs"]["mapping"]["properties"][_kind] = {"type": "object"}


def test_the_formats_example_is_valid() -> None:
    assert check(YAML(typ="safe", pure=True).load(SEARCH), SCHEMA_WITH_TREES) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [("scan:", "scna:"), ("tolerance: 0.3", "tolerance: far"), ("timeout: 60", "timout: 60"), ("turns: 1", "turn: 1")],
)
def test_mistakes_are_seen(old: str, new: str) -> None:
    assert check(YAML(typ="safe", pure=True).load(SEARCH.replace(old, new, 1)), SCHEMA_WITH_TREES)
