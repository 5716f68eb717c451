import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scripted_mission import NODES, VIEWPOINTS, candidate

from zavis_bt.recording import to_json, to_plain
from zavis_bt.types import NodeStatus, Pose2D

anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner),
    max_leaves=8,
)


@given(anything)
def test_everything_becomes_valid_json(value):
    json.loads(to_json(value), parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))


def test_values_of_the_framework_become_their_fields():
    assert to_plain(Pose2D(1.0, 2.0, 0.5)) == {"x": 1.0, "y": 2.0, "yaw": 0.5}
    assert to_plain(VIEWPOINTS[0])["pose"]["x"] == VIEWPOINTS[0].pose.x
    assert to_plain(NODES[0])["status"] == "RUNNING"
    assert type(to_plain(NodeStatus.RUNNING)) is str


def test_arrays_and_their_elements_become_numbers():
    assert to_plain({"a": np.arange(3), "b": np.float32(0.5), "c": np.bool_(True)}) == {
        "a": [0, 1, 2],
        "b": 0.5,
        "c": True,
    }


def test_numbers_json_does_not_know_become_null():
    assert to_plain([math.nan, math.inf, np.array([1.0, -np.inf])]) == [None, None, [1.0, None]]


def test_candidate_is_written_without_its_picture():
    plain = to_plain(candidate(1.0, 2.0, 30.0))
    assert plain == {
        "target": "alarm clock", "score": 30.0, "box": [70, 50, 90, 70], "position": [1.0, 2.0, 0.8], "stamp": 12.5,
    }  # fmt: skip


def test_sets_are_in_a_fixed_order_and_paths_are_text():
    assert to_plain({"kinds": {"b", "a"}, "file": Path("x/y")}) == {"kinds": ["a", "b"], "file": "x/y"}
