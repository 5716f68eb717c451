"""Mission inputs from the command line's texts."""

from __future__ import annotations

from typing import Any

import pytest

from zavis_bt.errors import InputError
from zavis_bt.tree import Port, TreeInput, parse_input
from zavis_bt.types import Pose2D


@pytest.mark.parametrize(
    ("type_", "text", "value"),
    [
        (str, "12", "12"),
        (str, "a red mug: mine", "a red mug: mine"),
        (int, "12", 12),
        (float, "12", 12.0),
        (float, ".inf", float("inf")),
        (bool, "true", True),
        (list[str], "sofa, bed", ["sofa", "bed"]),
        (list[str], "[sofa, bed]", ["sofa", "bed"]),
        (list[str], "", []),
        (list[float], "1, 2.5", [1.0, 2.5]),
        (Pose2D, "[1, 2, 0.5]", Pose2D(1.0, 2.0, 0.5)),
        (Pose2D, "1, 2", Pose2D(1.0, 2.0)),
        (Pose2D, "{x: 1, y: 2}", Pose2D(1.0, 2.0)),
    ],
)
def test_a_text_becomes_the_inputs_type(type_: Any, text: str, value: Any) -> None:
    parsed = parse_input(TreeInput("x", Port(type_)), text)
    assert parsed == value
    assert type(parsed) is type(value)


@pytest.mark.parametrize(
    ("port", "text", "message"),
    [
        (Port(int), "two", "x=two: 'x' takes int, not 'two'"),
        (Port(bool), "yes", "takes bool"),
        (Port(float, le=1.0), "3", r"'x' is 3.0 \(at most 1\)"),
        (Port(str, choices=("greedy", "nearest")), "gredy", "did you mean 'greedy'"),
        (Port(Pose2D), "here", "takes Pose2D"),
        (Port(int), "[", "takes int"),
    ],
)
def test_a_text_that_means_nothing_is_refused(port: Port, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_input(TreeInput("x", port), text)
