"""Types of ports: names, assignment, conversion."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from zavis_bt.errors import InputError
from zavis_bt.tree.datatypes import assignable, coercer, parse_type, type_name, type_names
from zavis_bt.types import Candidate, Pose2D, Viewpoint

NAMES = type_names()
SCALARS = st.sampled_from([str, int, float, bool, Pose2D, Viewpoint, Candidate])
PAIRS = st.tuples(SCALARS, SCALARS).map(lambda pair: pair[0] | pair[1])
TYPES = st.recursive(SCALARS | PAIRS, lambda inner: inner.map(lambda type_: list[type_]), max_leaves=3)


@given(TYPES)
def test_every_type_reads_back_from_its_name(type_: Any) -> None:
    assert parse_type(type_name(type_), NAMES) == type_


@given(TYPES)
def test_every_type_flows_into_itself_and_into_unions_with_it(type_: Any) -> None:
    assert assignable(type_, type_)
    assert assignable(type_, type_ | None)
    assert assignable(list[type_], list[type_ | None])


@pytest.mark.parametrize(
    ("source", "target", "fits"),
    [
        (int, float, True),
        (float, int, False),
        (bool, int, False),
        (list[int], list[float], True),
        (list[Viewpoint], list[Candidate], False),
        (Pose2D | None, Pose2D, False),
        (tuple[int, ...], list[int], True),
        (Literal["all"], str, True),
        (Any, Viewpoint, True),
        (list[Viewpoint], list[Any], True),
    ],
)
def test_what_flows_into_what(source: Any, target: Any, fits: bool) -> None:
    assert assignable(source, target) is fits


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Viewpont", "did you mean 'Viewpoint'"),
        ("list[", "is no type"),
        ("__import__('os')", "is no type"),
        ("dict[str, int]", "is no type"),
        ("", "is no type"),
    ],
)
def test_what_is_no_type_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_type(text, NAMES)


def test_classes_of_ports_are_known_by_name() -> None:
    class Charger:
        pass

    assert parse_type("list[Charger]", type_names([list[Charger]])) == list[Charger]


def test_numpy_scalars_become_pythons() -> None:
    assert type(coercer(float)(np.float32(0.5))) is float
    assert type(coercer(int)(np.int64(3))) is int
    assert type(coercer(bool)(np.bool_(True))) is bool


def test_a_union_prefers_the_exact_type() -> None:
    assert type(coercer(float | int)(3)) is int
    assert coercer(list[int] | None)((1, 2)) == [1, 2]
    with pytest.raises(TypeError, match=r"takes int \| none"):
        coercer(int | None)("x")
    with pytest.raises(TypeError, match="'forever'"):
        coercer(Literal["forever"])("never")
