"""Comparisons: a whitelist, evaluated and typed."""

from __future__ import annotations

import contextlib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from zavis_bt.errors import InputError
from zavis_bt.tree.condition import parse_condition

VALUES: dict[str, Any] = {"battery": 0.5, "round": 3, "found": None, "items": [1, 2], "mode": "fast $mode", "ok": True}


@pytest.mark.parametrize(
    ("text", "holds"),
    [
        ("$battery > 0.3", True),
        ("0.3 < $battery <= 0.5", True),
        ("$found == null", True),
        ("$found != null or $round >= 3", True),
        ("not $ok", False),
        ("$ok", True),
        ("$ok == true and $round == 3", True),
        ("len($items) == 2 and $round in [1, 2, 3]", True),
        ("$mode == 'fast $mode'", True),
        ("$battery > -1", True),
    ],
)
def test_comparisons_mean_what_they_say(text: str, holds: bool) -> None:
    assert bool(parse_condition(text).compile()(VALUES.__getitem__)) is holds


@pytest.mark.parametrize(
    "text",
    [
        *("", "$x = 3", "__import__('os')", "$x.real > 3", "$x[0] == 1", "open('f')", "lambda: 1", "x > 3", "$x is 3"),
        *("[i for i in $x]", "len($x, $y) > 1", "$x > 3; $y", "f'{1}' == $x", "-$x < 1", "$x + 1 > 2", "variable"),
    ],
)
def test_anything_else_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="is no comparison"):
        parse_condition(text)


@given(st.text(alphabet="$xy0 <>=!()[]'\".,+-*/andort", max_size=20))
def test_no_text_does_more_than_being_refused(text: str) -> None:
    with contextlib.suppress(InputError, TypeError):  # the latter where what is compared has no order
        parse_condition(text).compile()(lambda name: {"x": 1, "y": "a"}.get(name))


def test_names_are_told_once() -> None:
    assert parse_condition("$a > 1 and $b > $a").names == ("a", "b")


def test_types_that_cannot_be_compared_are_told() -> None:
    condition = parse_condition("$a < $b and $c == 3 and $a == null")
    assert condition.type_faults({"a": str, "b": float, "c": int}) == [f"'{condition.text}' compares str with float"]
