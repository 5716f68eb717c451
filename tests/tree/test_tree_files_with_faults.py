"""Broken files: every fault is reported at its exact place, with a remedy, and all at once."""

from __future__ import annotations

from pathlib import Path

import pytest
from tree_kinds import REGISTRY, SAFETY, SEARCH, tree_text, write

from zavis_bt.errors import TreeError
from zavis_bt.tree import check_tree, load_tree

# Trees of one node; the fault's line and column count in the YAML below ``do:``, whose first line is the file's sixth
# and whose lines begin in the file's seventh column.
NODES = {
    "unknown kind": ("scna", "1:1: error[kind]: unknown kind 'scna' (did you mean 'scan'?)"),
    "two kinds": ("scan: {}\ngo_home: {}", "2:1: error[kind]: two kinds in one node: 'scan' and 'go_home'"),
    "no kind": ("retry: 3", "1:1: error[kind]: no kind beside 'retry' (a node is a kind"),
    "number as node": ("3", "1:1: error[structure]: a node is a kind, such as 'scan'"),
    "misspelt modifier": (
        "scan: {}\ntimeot: 3",
        "2:1: error[modifier]: unknown modifier 'timeot' beside 'scan' (did you",
    ),
    "recover alone": (
        "scan: {}\nrecover: go_home",
        "2:1: error[modifier]: 'recover' belongs to 'retry', not to 'scan'",
    ),
    "do beside leaf": ("scan: {}\ndo: go_home", "2:1: error[modifier]: 'do' belongs to a kind with a block"),
    "name is no text": ("scan: {}\nname: 3", "2:7: error[modifier]: 'name' is a text"),
    "saved with dollar": (
        "produce: {}\nsave: {total: $sum}",
        "2:15: error[modifier]: 'total' is saved to the name of a",
    ),
    "retry of nothing": ("scan: {}\nretry: 0", "2:8: error[range]: 'attempts' is 0 (at least 1)"),
    "timeout in words": ("scan: {}\ntimeout: long", "2:10: error[type]: 'seconds' takes float, not 'long'"),
    "unknown argument": (
        "scan: {turn: 1}",
        "1:8: error[argument]: 'scan' has no argument 'turn' (did you mean 'turns'?)",
    ),
    "no arguments": ("go_home: [1]", "1:10: error[structure]: arguments of 'go_home' are a mapping, such as"),
    "wrong type": ("scan: {turns: two}", "1:15: error[type]: 'turns' takes int, not 'two'"),
    "text as number": ('back_up: {distance: "1"}', "1:21: error[type]: 'distance' takes float, not '1'"),
    "out of range": ("back_up: {distance: 0}", "1:21: error[range]: 'distance' is 0.0 m (more than 0 m)"),
    "not a choice": ("act: {ends: succes}", "1:13: error[range]: 'ends' is 'succes' (did you mean 'success'?)"),
    "missing argument": ("back_up", "1:1: error[missing-argument]: 'back_up' needs 'distance': how far"),
    "unwritable type": (
        "confirm: {candidates: [1]}",
        "1:23: error[type]: 'candidates' takes list[Candidate], which cannot",
    ),
    "inner value": ("navigate: {goal: {x: 1, y: north}}", "error[type]: 'goal"),
    "unknown variable": ("consume: {value: $sum}", "1:18: error[name]: unknown variable '$sum'"),
    "no name": ("consume: {value: $1}", "1:18: error[reference]: '$1' is no variable (write $$ for a dollar sign)"),
    "reference inside": (
        "navigate: {goal: [$x, 1]}",
        "1:19: error[reference]: '$x' stands inside a value (only a whole",
    ),
    "no output": ("scan: {}\nsave: {area: a}", "2:8: error[argument]: 'scan' has no output 'area' (it has none)"),
    "unused output": ("produce: {}\nsave: {total: sum}", "2:8: error[unused]: 'sum' is written but never read"),
    "no comparison": ("when: import os", "1:7: error[condition]: 'import os' is no comparison (such as $battery > 0.3"),
    "call in comparison": ("when: open('x') == 1", "1:7: error[condition]: 'open('x') == 1' is no comparison"),
    "guard without do": ("guard: {while: [scan]}", "1:1: error[structure]: 'guard' needs 'do'"),
    "empty sequence": ("sequence: []", "1:11: error[structure]: 'do' has no nodes"),
    "sequence of nothing": ("sequence: {scan: {}}", "1:11: error[structure]: 'sequence' takes a list of nodes"),
    "loop variable from a variable": (
        "{sequence: [{set: {x: a}}, {for_each: {items: [1], as: $x}, do: scan}]}",
        "1:56: error[reference]: 'as' of 'for_each' is written out, not taken from $x",
    ),
    "loop variable is no name": (
        "for_each: {items: [1], as: a-b}\ndo: scan",
        "1:28: error[name]: 'a-b' is no name of a",
    ),
    "alias": ("sequence:\n  - &a {scan: {}}\n  - *a", "error[syntax]: an alias of a list or mapping"),
    "tag": ("succeed: !!python/name:os.system x", "1:10: error[syntax]: the tag 'python/name:os.system'"),
}


@pytest.mark.parametrize("name", NODES)
def test_a_faulty_node_is_reported_at_its_place(tmp_path: Path, name: str) -> None:
    text, expected = NODES[name]
    path = write(tmp_path, tree_text(text))
    with pytest.raises(TreeError) as caught:
        check_tree(path, REGISTRY)
    place, _, rest = expected.partition(": ")
    if place[0].isdigit():
        line, column = map(int, place.split(":"))
        expected = f"{path}:{line + 5}:{column + 6}: {rest}"
    assert expected in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


FILES = {
    "syntax": ("bt: 1\nroot: [main\ntrees: {}\n", "3:6: error[syntax]: expected ',' or ']'"),
    "tab": ("bt: 1\ntrees:\n\tmain: {do: scan}\n", "3:1: error[syntax]: found character '\\t'"),
    "duplicate key": (
        "bt: 1\nroot: m\nroot: m\ntrees: {m: {do: scan}}\n",
        "3:1: error[duplicate-key]: 'root' is already",
    ),
    "newer": ("bt: 2\nroot: m\ntrees: {m: {do: scan}}\n", "1:5: error[version]: format 2 is newer than this program"),
    "no version": ("root: m\ntrees: {m: {do: scan}}\n", "1:1: error[version]: the format's version is missing (begin"),
    "version in words": ("bt: one\ntrees: {}\n", "1:5: error[version]: there is no format 'one' (it is bt: 1)"),
    "missing root": (
        "bt: 1\ntrees: {m: {do: scan}}\n",
        "1:1: error[root]: 'root' is missing, the tree to run (such as",
    ),
    "unknown root": (
        "bt: 1\nroot: mn\ntrees: {m: {do: scan}}\n",
        "2:7: error[root]: there is no tree 'mn' (did you mean",
    ),
    "unknown key": (
        "bt: 1\nroot: m\ntree: {}\ntrees: {m: {do: scan}}\n",
        "3:1: error[structure]: unknown key 'tree' in a",
    ),
    "no trees": ("bt: 1\nroot: m\n", "1:1: error[structure]: 'trees' is a mapping"),
    "tree without do": ("bt: 1\nroot: m\ntrees: {m: {}}\n", "3:9: error[structure]: tree 'm' needs 'do'"),
    "missing include": (
        "bt: 1\ninclude: [safty.yaml]\nroot: m\ntrees: {m: {do: scan}}\n",
        "2:11: error[include]: ",
    ),
    "recursion": (
        "bt: 1\nroot: m\ntrees:\n  m: {do: {sequence: [n]}}\n  n: {do: {invert: m}}\n",
        "5:20: error[recursion]: tree 'm' contains itself: m → n → m (repeat with retry or repeat)",
    ),
    "unknown type": (
        "bt: 1\nroot: m\ntrees: {m: {params: {a: flaot}, do: scan}}\n",
        "3:25: error[type]: unknown type 'flaot' (did you mean 'float'?)",
    ),
    "default of another type": (
        "bt: 1\nroot: m\ntrees: {m: {params: {a: {type: int, default: x}}, do: scan}}\n",
        "3:46: error[type]: 'default' takes int, not 'x'",
    ),
    "kind's name": (
        "bt: 1\nroot: m\ntrees: {m: {do: scan}, scan: {do: m}}\n",
        "3:24: error[name]: tree 'scan' has the name",
    ),
    "declared twice": (
        "bt: 1\nroot: m\ntrees: {m: {params: {a: int}, in: {a: int}, do: scan}}\n",
        "3:36: error[name]: 'a' is already declared in line 3",
    ),
    "output never written": (
        "bt: 1\nroot: m\ntrees: {m: {out: {a: int}, do: scan}}\n",
        "3:19: error[unwritten]: nothing writes the output 'a'",
    ),
    "empty": ("", "1:1: error[structure]: a tree file is a mapping"),
}


@pytest.mark.parametrize("name", FILES)
def test_a_faulty_file_is_reported_at_its_place(tmp_path: Path, name: str) -> None:
    text, expected = FILES[name]
    write(tmp_path, SAFETY, "safety.yaml")
    path = write(tmp_path, text)
    with pytest.raises(TreeError) as caught:
        check_tree(path, REGISTRY)
    assert f"{path}:{expected}" in str(caught.value)


def test_a_missing_include_names_the_file_that_was_meant(tmp_path: Path) -> None:
    write(tmp_path, SAFETY, "safety.yaml")
    path = write(tmp_path, FILES["missing include"][0])
    with pytest.raises(TreeError, match=r"No such file.*did you mean 'safety.yaml'"):
        check_tree(path, REGISTRY)


def test_files_that_include_each_other_are_refused(tmp_path: Path) -> None:
    head = "bt: 1\ninclude: [{}]\nroot: m\ntrees: {{m: {{do: scan}}}}\n"
    path = write(tmp_path, head.format("b.yaml"), "a.yaml")
    write(tmp_path, head.format("a.yaml"), "b.yaml")
    with pytest.raises(TreeError, match=r"b.yaml:2:11: error\[include\]: 'a.yaml' includes itself: a.yaml → b"):
        check_tree(path, REGISTRY)


def test_faults_of_an_included_file_name_that_file(tmp_path: Path) -> None:
    write(tmp_path, SAFETY.replace("go_home", "go_hme"), "safety.yaml")
    path = write(tmp_path, SEARCH)
    with pytest.raises(TreeError) as caught:
        load_tree(path, REGISTRY, {"target": "mug"})
    assert (
        str(caught.value)
        == f"{tmp_path}/safety.yaml:9:11: error[kind]: unknown kind 'go_hme' (did you mean 'go_home'?)"
    )


def test_all_faults_are_reported_at_once_in_the_order_of_the_file(tmp_path: Path) -> None:
    broken = (
        SEARCH.replace("turns: 1}\n          name", "turns: no}\n          nam")
        .replace("$waypoints,", "$waypoint,")
        .replace("tolerance: 0.3", "tolerance: 30")
        .replace("retry: 3\n", "retry: 3.5\n")
    )
    write(tmp_path, SAFETY, "safety.yaml")
    path = write(tmp_path, broken)
    with pytest.raises(TreeError) as caught:
        check_tree(path, REGISTRY)
    lines = str(caught.value).splitlines()
    tokens = ("no}", "nam:", "waypoints: waypoints}", "$waypoint,", "30}", "3.5")
    assert [line.removeprefix(f"{path}:").partition(": ")[0] for line in lines] == [_place(broken, t) for t in tokens]


def _place(text: str, token: str) -> str:
    before = text[: text.index(token)]
    return f"{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}"


def test_an_unreadable_file_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(TreeError, match=r"none.yaml: cannot be read: No such file"):
        check_tree(tmp_path / "none.yaml", REGISTRY)
    (tmp_path / "b.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(TreeError, match="is no UTF-8 text"):
        check_tree(tmp_path / "b.yaml", REGISTRY)
