"""The canonical form: byte for byte where a file has it, reached in one go, nothing lost."""

from __future__ import annotations

import json
from io import StringIO

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML
from tree_kinds import SAFETY, SEARCH

from zavis_bt.errors import InputError, TreeError
from zavis_bt.tree.document import parse_document
from zavis_bt.tree.formatting import format_text


@pytest.mark.parametrize("text", [SEARCH, SAFETY])
def test_a_canonical_file_stays_as_it_is(text: str) -> None:
    assert format_text(text) == text


def test_indentation_and_order_of_modifiers_are_brought_to_the_canonical_form() -> None:
    untidy = """\
bt:   1
# what to run
root: main
trees:
    main:
        do:
            sequence:
            - timeout: 3   # seconds
              scan: {  turns: 1 }
              name: look around
            - when: "$x > 1"
              retry: {attempts: 3, do: {timeout: 2, scan: {}}}
"""
    assert (
        format_text(untidy)
        == """\
bt: 1
# what to run
root: main
trees:
  main:
    do:
      sequence:
        - scan: {turns: 1}
          name: look around
          timeout: 3       # seconds
        - retry: {attempts: 3, do: {scan: {}, timeout: 2}}
          when: "$x > 1"
"""
    )


def test_keys_stay_where_moving_them_would_misplace_a_comment() -> None:
    text = """\
bt: 1
trees:
  main:
    do:
      sequence:
        - timeout: 3
          # why it scans
          scan: {turns: 1}
"""
    assert format_text(text) == text


def test_a_malformed_file_is_a_treeerror() -> None:
    with pytest.raises(TreeError, match=r"t.yaml:2:1: error\[duplicate-key\]"):
        format_text("bt: 1\nbt: 1\n", "t.yaml")


NODES = st.recursive(
    st.sampled_from(["scan", "go_home", {"fail": "x"}, {"navigate": {"goal": [1, 2.5], "tolerance": 0.3}}]),
    lambda inner: (
        st.builds(
            lambda kind, more: {kind: more},
            st.sampled_from(["sequence", "selector"]),
            st.lists(inner, min_size=1, max_size=3),
        )
        | st.builds(
            lambda when, node: {"when": when, "timeout": 3, "invert": node}, st.sampled_from(["$x > 1", "1 < 2"]), inner
        )
    ),
    max_leaves=6,
)


@settings(max_examples=40, deadline=None)
@given(node=NODES, flow=st.booleans(), mapping=st.integers(2, 6), width=st.integers(20, 120))
def test_formatting_twice_is_formatting_once_and_keeps_the_content(
    node: object, flow: bool, mapping: int, width: int
) -> None:
    node = json.loads(json.dumps(node))  # the same part twice would be written as an alias
    yaml = YAML(typ="safe", pure=True)
    yaml.default_flow_style = flow
    yaml.indent(mapping=mapping, sequence=mapping + 2, offset=mapping)
    yaml.width = width
    out = StringIO()
    yaml.dump({"bt": 1, "root": "main", "trees": {"main": {"do": node}}}, out)
    once = format_text(out.getvalue())
    assert format_text(once) == once
    before, after = (parse_document(text, "t")[0] for text in (out.getvalue(), once))
    assert before is not None
    assert after is not None
    assert before.plain == after.plain


@settings(max_examples=60, deadline=None)
@given(st.text(alphabet="ab:- \n#'\"[]{},&*!|>%", max_size=40))
def test_any_text_is_formatted_or_refused(text: str) -> None:
    try:
        once = format_text(text)
    except InputError:
        return
    assert format_text(once) == once
