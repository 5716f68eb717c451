from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, Field
from ruamel.yaml import YAML

from zavis_bt.documents import check, read_document
from zavis_bt.errors import InputError


class Part(BaseModel):
    model_config = ConfigDict(extra="forbid")

    size: tuple[float, float]
    colour: str | None = None


class Whole(BaseModel):
    model_config = ConfigDict(extra="forbid")

    name: str
    parts: list[Part] = []
    count: int = Field(default=1, ge=1)


def read(folder: Path, text: str) -> Any:
    path = folder / "file.yaml"
    path.write_text(text, encoding="utf-8")
    return read_document(path)


def test_scalars_follow_the_core_schema(tmp_path: Path) -> None:
    text = "{a: 1, b: -2.5, c: 1e3, d: true, e: on, f: '7', g: ~, h: , i: .5, j: 1.2.3, k: no, l: +3, m: 2., n: x y}"
    assert read(tmp_path, text).data == {
        "a": 1, "b": -2.5, "c": 1000.0, "d": True, "e": "on", "f": "7", "g": None, "h": None, "i": 0.5, "j": "1.2.3",
        "k": "no", "l": 3, "m": 2.0, "n": "x y",
    }  # fmt: skip


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-99999, 99999) | st.floats(-1e6, 1e6) | st.text("ab -#'\"é", max_size=6),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text("abc", min_size=1), inner, max_size=4),
    max_leaves=12,
)


@given(VALUES)
def test_what_a_yaml_writer_wrote_is_read_back(tmp_path_factory: pytest.TempPathFactory, value: object) -> None:
    path = tmp_path_factory.getbasetemp() / "written.yaml"
    with path.open("w", encoding="utf-8") as file:
        YAML(typ="safe", pure=True).dump({"value": value}, file)
    assert read_document(path).data == {"value": value}


def test_every_value_knows_its_line(tmp_path: Path) -> None:
    document = read(tmp_path, "name: x\nparts:\n  - size: [1,\n           2]\n  - {size: [3, 4]}\n")
    assert document.where("name").endswith(":1")
    assert document.where("parts", 0, "size", 1).endswith(":4")
    assert document.where("parts", 1, "size").endswith(":5")
    assert document.where("parts", 1, "size", 7, "none").endswith(":5")


def test_anchors_are_followed(tmp_path: Path) -> None:
    assert read(tmp_path, "a: &one [1, 2]\nb: *one\n").data == {"a": [1, 2], "b": [1, 2]}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\nb: 2\na: 3\n", ":3: key 'a' occurs twice"),
        ("a: [1\nb: 2\n", "is not YAML"),
        ("a: *x\n", "anchor|alias"),
        ("[a, b]: 1\n", "a key must be a word"),
        ("a: \x01\n", "is not YAML"),
    ],
)
def test_what_is_not_read_is_an_input_error_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        read(tmp_path, text)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(str(tmp_path / "file.yaml"))


def test_text_in_another_encoding_is_an_input_error(tmp_path: Path) -> None:
    (tmp_path / "file.yaml").write_bytes(b"name: \xff\xfe")
    with pytest.raises(InputError, match="UTF-8"):
        read_document(tmp_path / "file.yaml")


def test_a_right_document_becomes_the_model(tmp_path: Path) -> None:
    whole, faults = check(read(tmp_path, "name: x\nparts: [{size: [1, 2]}]\n"), Whole)
    assert faults == []
    assert whole is not None
    assert whole.parts[0].size == (1.0, 2.0)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (
            "name: x\nparts:\n  - {size: [1, 2], color: red}\n",
            ":3: unknown key 'parts[0].color' (did you mean 'colour'?)",
        ),
        ("name: x\npart: []\n", ":2: unknown key 'part' (did you mean 'parts'?)"),
        ("name: x\nparts: [{}]\n", ":2: key 'parts[0].size' is missing"),
        ("name: x\ncount: 0\n", ":2: count: should be greater than or equal to 1, not 0"),
        ("name: x\ncount: many\n", "not 'many'"),
        ("name: [x]\n", ":1: name: should be a valid string"),
    ],
)
def test_a_fault_names_line_key_and_what_would_be_right(tmp_path: Path, text: str, fault: str) -> None:
    whole, faults = check(read(tmp_path, text), Whole)
    assert whole is None
    assert fault in faults[0]
