"""Flow of data: written before read on every way, fitting types and units."""

from __future__ import annotations

from pathlib import Path

import pytest
from tree_kinds import REGISTRY, tree_text, write

from zavis_bt.errors import TreeError
from zavis_bt.tree import check_tree

PRODUCE = "{produce: {}, save: {total: s}}"
READ = "{consume: {value: $s}}"

GOOD = {
    "in turn": f"sequence: [{PRODUCE}, {READ}]",
    "in both branches": f"sequence: [selector: [{PRODUCE}, {{set: {{s: 3}}}}], {READ}]",
    "after a failure": f"selector: [sequence: [{PRODUCE}, go_home], {READ}]",
    "set first": f"sequence: [{{set: {{s: 0}}}}, {{selector: [go_home, {PRODUCE}]}}, {READ}]",
    "in a loop": "sequence: [{produce: {}, save: {numbers: n}}, {for_each: {items: $n, as: s}, do: " + READ + "}]",
    "twice the same item": "sequence: [{produce: {}, save: {numbers: n}}"
    + ", {for_each: {items: $n, as: s}, do: {consume: {value: $s}}}" * 2
    + "]",
    "after a loop that found it": "sequence: [{for_each: {items: [1], as: i, until: success}, do: "
    f"{{sequence: [{{consume: {{value: $i}}}}, {PRODUCE}]}}}}, {READ}]",
    "beside a monitor": f"parallel: {{do: [{PRODUCE}, {READ}]}}",
    "after an inverted failure": f"sequence: [invert: {{sequence: [{PRODUCE}, fail: x]}}, {READ}]",
    "behind what always fails": f"selector: [sequence: [fail: x, {READ}], {PRODUCE}]",
    "in a guard": f"guard: {{while: [{PRODUCE}], do: {READ}}}",
    "in recovery": f"{{{PRODUCE[1:-1]}, retry: 2, recover: {READ}}}",
    "by a comparison": f"sequence: [{PRODUCE}, when: $s > 3 and not $s == 4]",
}

UNWRITTEN = {
    "before the writer": f"sequence: [{READ}, {PRODUCE}]",
    "left out by a selector": f"sequence: [selector: [go_home, {PRODUCE}], {READ}]",
    "left out by a failed sequence": f"selector: [sequence: [go_home, {PRODUCE}], {READ}]",
    "after a loop that may be empty": "sequence: [{for_each: {items: [1], as: i, until: failure}, do: "
    f"{{sequence: [{{consume: {{value: $i}}}}, {PRODUCE}]}}}}, {READ}]",
    "after a timeout": f"selector: [{{sequence: [{PRODUCE}], timeout: 3}}, {READ}]",
    "when it was not started": f"selector: [{{{PRODUCE[1:-1]}, when: 1 > 2}}, {READ}]",
    "in else": f"guard: {{while: [go_home], do: {PRODUCE}, else: {READ}}}",
    "in the first round": f"{{sequence: [{READ}, {PRODUCE}], repeat: 2}}",
    "outside the loop": "sequence: [{for_each: {items: [1], as: s}, do: " + READ + "}, " + READ + "]",
}


@pytest.mark.parametrize("name", GOOD)
def test_what_is_written_on_every_way_may_be_read(tmp_path: Path, name: str) -> None:
    check_tree(write(tmp_path, tree_text("{" + GOOD[name] + "}" if GOOD[name][0] != "{" else GOOD[name])), REGISTRY)


@pytest.mark.parametrize("name", UNWRITTEN)
def test_what_a_way_leaves_out_must_not_be_read(tmp_path: Path, name: str) -> None:
    text = UNWRITTEN[name] if UNWRITTEN[name][0] == "{" else "{" + UNWRITTEN[name] + "}"
    with pytest.raises(TreeError, match=r"error\[unwritten\]: '\$s' is"):
        check_tree(write(tmp_path, tree_text(text)), REGISTRY)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "sequence: [{produce: {}, save: {numbers: n}}, {consume: {value: $n}}]",
            r"takes float, but \$n is list\[int\] \[m\]",
        ),
        ("sequence: [{set: {s: far}}, {consume: {value: $s}}]", r"'value' takes float, but \$s is str"),
        ("sequence: [{set: {s: null}}, {consume: {value: $s}}]", r"'value' takes float, but \$s is none"),
        ("sequence: [{set: {s: far}}, {when: $s < 3}]", r"'\$s < 3' compares str with int"),
        ("sequence: [{set: {s: far}}, {set: {s: 3}}, {fail: $s}]", r"'s' is str \(line 6\), but int is written here"),
        (
            "sequence: [{set: {n: 3}}, {for_each: {items: $n, as: i}, do: scan}]",
            r"'items' takes list\[any\], but \$n is int",
        ),
        (
            "sequence: [{set: {n: [3]}}, {for_each: {items: $n, as: n}, do: scan}]",
            "'n' is already a variable of this tree",
        ),
    ],
)
def test_types_must_fit(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(TreeError, match=message):
        check_tree(write(tmp_path, tree_text("{" + text + "}")), REGISTRY)


def test_units_must_fit(tmp_path: Path) -> None:
    text = "bt: 1\nroot: m\ntrees: {m: {in: {a: {type: float, unit: rad}}, do: {back_up: {distance: $a}}}}\n"
    with pytest.raises(TreeError, match=r"'distance' is in m, but \$a is in rad"):
        check_tree(write(tmp_path, text), REGISTRY)


@pytest.mark.parametrize("name", ["a", "b", "g"])
def test_params_inputs_and_items_cannot_be_written(tmp_path: Path, name: str) -> None:
    block = "params: {a: int}, in: {b: int}"
    do = f"{{for_each: {{items: [1], as: g}}, do: {{produce: {{}}, save: {{total: {name}}}}}}}"
    text = f"bt: 1\nroot: m\ntrees: {{m: {{{block}, do: {do}}}}}\n"
    with pytest.raises(TreeError, match=rf"'{name}' is .*, which cannot be written \(choose another name\)"):
        check_tree(write(tmp_path, text), REGISTRY)


def test_an_optional_input_may_read_what_is_not_written_yet(tmp_path: Path) -> None:
    do = "{selector: [{sequence: [go_home, {produce: {}, save: {total: s}}]}, {consume: {value: 1, wanted: $s}}]}"
    check_tree(write(tmp_path, tree_text(do)), REGISTRY)


def test_what_flows_through_calls_is_checked_by_type(tmp_path: Path) -> None:
    inner = "{in: {v: float}, do: {consume: {value: $v}}}"
    text = f"bt: 1\nroot: m\ntrees:\n  m: {{params: {{w: str}}, do: {{n: {{v: $w}}}}}}\n  n: {inner}\n"
    with pytest.raises(TreeError, match=r"4:37: error\[type\]: 'v' takes float, but \$w is str"):
        check_tree(write(tmp_path, text), REGISTRY)
