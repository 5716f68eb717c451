"""Loading: the format's example, ids, params and ports, includes, globals; nothing but TreeError on nonsense."""

from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tree_kinds import REGISTRY, SAFETY, SEARCH, Bench, Consume, bench, write

from zavis_bt.errors import TreeError
from zavis_bt.tree import Status, check_tree, load_tree, read_inputs
from zavis_bt.types import Pose2D, Viewpoint


@pytest.fixture
def search(tmp_path: Path) -> Path:
    write(tmp_path, SAFETY, "safety.yaml")
    return write(tmp_path, SEARCH, "search.yaml")


def test_the_formats_example_runs(search: Path) -> None:
    mission = Bench(load_tree(search, REGISTRY, {"target": "mug"}))
    assert mission.tick() is Status.RUNNING
    assert mission.to_the_end(400) is Status.FAILURE
    failure = mission.tree.failure()
    assert failure is not None
    assert (failure.id, failure.reason) == ("mission/sequence.1/selector.1/sequence.2/fail", "searched")


def test_ids_are_paths_in_the_file(search: Path) -> None:
    nodes = {state.id: state for state in check_tree(search, REGISTRY).nodes()}
    assert nodes["mission/sequence.0/scan"].name == "initial scan"
    assert nodes["mission/sequence.0/scan"].kind == "scan"
    assert nodes["mission/sequence.1/selector"].depth == nodes["mission/sequence.0/scan"].depth
    assert "search/guard.while.1/battery_above" in nodes
    assert "search/guard.else/safety.dock" in nodes
    assert "visit/sequence.0/recover/back_up" in nodes


def test_ids_of_a_tree_called_twice_tell_the_calls_apart(tmp_path: Path) -> None:
    text = "bt: 1\nroot: m\ntrees:\n  m: {do: {sequence: [n, n]}}\n  n: {do: scan}\n"
    ids = [state.id for state in check_tree(write(tmp_path, text), REGISTRY).nodes()]
    assert ids == ["m", "m/sequence", *(f"m/sequence.{i}/n{rest}" for i in (0, 1) for rest in ("", "/scan"))]


def test_modifiers_nest_in_a_fixed_order(tmp_path: Path) -> None:
    one = "act: {}\nwhen: 1 < 2\nretry: 2\nname: x\nrepeat: 3\ntimeout: 4"
    two = "timeout: 4\nrepeat: 3\nname: x\nretry: 2\nact: {}\nwhen: 1 < 2"
    kinds = [[state.kind for state in bench(tmp_path, text).tree.nodes()] for text in (one, two)]
    assert kinds[0] == kinds[1] == ["main", "when", "repeat", "retry", "timeout", "act"]


def test_another_order_is_written_out(tmp_path: Path) -> None:
    tree = bench(tmp_path, "timeout: {seconds: 300, do: {act: {}, retry: 2}}\nrepeat: forever").tree
    assert [state.kind for state in tree.nodes()] == ["main", "repeat", "timeout", "retry", "act"]


def test_a_block_may_stand_beside_its_kind(tmp_path: Path) -> None:
    tree = bench(tmp_path, "timeout: 3\ndo: {retry: 2, do: scan}").tree
    assert [state.kind for state in tree.nodes()] == ["main", "timeout", "retry", "scan"]


def test_params_are_constants_and_inputs_values(tmp_path: Path) -> None:
    text = """\
bt: 1
root: main
trees:
  main:
    params: {tries: {type: int, default: 2}, who: str}
    do:
      sequence:
        - produce: {count: $tries}
          save: {total: sum}
        - inner: {value: $sum, tries: $tries, reason: $who}
  inner:
    params: {tries: int, reason: str}
    in: {value: float}
    do:
      selector:
        - consume: {value: $value, wanted: 100}
          retry: $tries
        - fail: $reason
"""
    mission = Bench(load_tree(write(tmp_path, text), REGISTRY, {"who": "nobody"}))
    assert mission.to_the_end() is Status.FAILURE
    assert mission.tree.reason == "nobody"
    assert _consumer(mission).seen == [1.0, 1.0]


def _consumer(mission: Bench) -> Consume:
    return next(node for node in mission.tree.root.iterate() if isinstance(node, Consume))


def test_outputs_of_a_tree_reach_its_caller(tmp_path: Path) -> None:
    text = """\
bt: 1
root: main
trees:
  main:
    do:
      sequence:
        - inner
        - inner: {count: 5}
          save: {sum: mine}
        - consume: {value: $mine}
  inner:
    params: {count: {type: int, default: 2}}
    out: {sum: float}
    do:
      sequence:
        - produce: {count: $count}
          save: {total: sum}
        - consume: {value: $sum}
"""
    mission = Bench(load_tree(write(tmp_path, text), REGISTRY))
    assert mission.to_the_end() is Status.SUCCESS
    consumers = [node for node in mission.tree.root.iterate() if isinstance(node, Consume)]
    assert [node.seen for node in consumers] == [[1.0], [10.0], [10.0]]
    assert mission.tree.variables["main.mine"] == 10.0


def test_a_params_value_out_of_range_is_reported_where_it_is_used(search: Path) -> None:
    with pytest.raises(TreeError, match=r":12:36: error\[range\]: 'level' is 3.0 \(at most 1\), from \$min_battery"):
        load_tree(search, REGISTRY, {"target": "mug", "min_battery": 3})


def test_what_changes_cannot_be_a_constant(tmp_path: Path) -> None:
    text = "bt: 1\nroot: m\ntrees:\n  m: {do: {sequence: [{produce: {}, save: {total: s}}, {scan: {}, retry: $s}]}}\n"
    with pytest.raises(TreeError, match=r"4:74: error\[reference\]: 'attempts' of 'retry' must be known when"):
        check_tree(write(tmp_path, text), REGISTRY)


def test_inputs_are_told_without_giving_them(search: Path) -> None:
    inputs = read_inputs(search, REGISTRY)
    assert [(item.name, item.type_name, item.required, item.default) for item in inputs] == [
        ("target", "str", True, None),
        ("min_battery", "float", False, 0.2),
    ]


def test_wrong_inputs_are_reported_together(search: Path) -> None:
    with pytest.raises(TreeError) as caught:
        load_tree(search, REGISTRY, {"targt": "mug", "min_battery": "low"})
    lines = [line.partition("search.yaml:")[2] for line in str(caught.value).splitlines()]
    assert lines == [
        "6:3: error[input]: tree 'search' has no input 'targt' (did you mean 'target'?)",
        "7:14: error[input]: tree 'search' needs the input 'target' (str)",
        "7:27: error[input]: 'min_battery' takes float, not 'low'",
    ]


def test_globals_are_shared_by_all_trees(tmp_path: Path) -> None:
    text = """\
bt: 1
root: main
globals: {best: {type: float, default: -1.0}, last: {type: float, default: null}}
trees:
  main:
    do:
      sequence:
        - consume: {value: $best, wanted: -5}
        - inner
        - consume: {value: $best, wanted: 3}
  inner:
    do: {produce: {}, save: {total: best}}
"""
    mission = Bench(load_tree(write(tmp_path, text), REGISTRY))
    assert mission.tree.variables == {"best": -1.0, "last": None}
    assert mission.to_the_end() is Status.SUCCESS
    assert mission.tree.variables["best"] == 3.0
    mission.tree.write("best", 7)
    assert mission.tree.variables["best"] == 7.0


def test_variables_of_a_tree_begin_anew_with_each_start(tmp_path: Path) -> None:
    text = """\
bt: 1
root: main
trees:
  main:
    do: {inner: {}, repeat: 2}
  inner:
    do:
      selector:
        - sequence:
            - when: $seen == true
            - fail: still there
        - set: {seen: true}
"""
    with pytest.raises(TreeError, match=r"'\$seen' is read before it is written"):
        load_tree(write(tmp_path, text), REGISTRY)


def test_two_trees_in_one_process_share_nothing(tmp_path: Path) -> None:
    text = "sequence:\n  - produce: {count: %d}\n    save: {total: sum}\n  - consume: {value: $sum}"
    one, other = (bench(tmp_path, text % count) for count in (3, 5))
    one.to_the_end()
    other.to_the_end()
    assert (one.tree.variables["main.sum"], other.tree.variables["main.sum"]) == (3, 10)


def test_literals_become_values_of_the_ports_types(tmp_path: Path) -> None:
    text = "sequence:\n  - navigate: {goal: [1, 2]}\n  - navigate: {goal: {x: 1, y: 2.0, yaw: 0.5}}\n"
    goals = [node.goal for node in bench(tmp_path, text).tree.root.iterate() if hasattr(node, "goal")]
    assert goals == [Pose2D(1.0, 2.0), Pose2D(1.0, 2.0, 0.5)]


def test_a_dollar_sign_can_be_written(tmp_path: Path) -> None:
    mission = bench(tmp_path, "fail: $$5 are missing")
    mission.tick()
    assert mission.tree.reason == "$5 are missing"


def test_a_tree_that_takes_a_viewpoint_gets_it_from_outside(tmp_path: Path) -> None:
    inputs = "{goal: Viewpoint, names: {type: 'list[str]', default: []}}"
    text = f"bt: 1\nroot: m\ntrees: {{m: {{in: {inputs}, do: {{look: {{at: $goal}}}}}}}}\n"
    view = Viewpoint(Pose2D(0, 0), (0, 0, 0), 0.1, 0, "desk")
    tree = load_tree(write(tmp_path, text), REGISTRY, {"goal": view, "names": ["a"]})
    assert Bench(tree).tick() is Status.SUCCESS


STRUCTURE = ("bt", "root", "trees", "main", "do", "params", "in", "out", "type", "default", "int", "include", "globals")
CONTROL = ("sequence", "guard", "while", "else", "retry", "timeout", "for_each", "items", "as", "until", "when", "set")
LEAVES = (
    "parallel",
    "recover",
    "repeat",
    "save",
    "name",
    "scan",
    "act",
    "produce",
    "total",
    "navigate",
    "goal",
    "$x",
    "x",
)
WORDS = st.sampled_from([*STRUCTURE, *CONTROL, *LEAVES])
VALUES = st.recursive(
    WORDS | st.none() | st.booleans() | st.integers(-3, 3) | st.floats(allow_nan=True) | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(WORDS, inner, max_size=4),
    max_leaves=12,
)


def _dump(value: object) -> str:
    from io import StringIO

    from ruamel.yaml import YAML

    out = StringIO()
    YAML(typ="safe", pure=True).dump(value, out)
    return out.getvalue()


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
@given(do=VALUES, more=st.dictionaries(WORDS, VALUES, max_size=2))
def test_whatever_stands_in_a_tree_raises_only_treeerror(tmp_path: Path, do: object, more: dict[str, object]) -> None:
    document = {"bt": 1, "root": "main", "trees": {"main": {"do": do, **more}, "other": {"do": "scan"}}}
    with contextlib.suppress(TreeError):
        check_tree(write(tmp_path, _dump(document)), REGISTRY)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=st.text(alphabet=st.sampled_from("abt:1-[]{}&*!|>'\"%@`#?,$ \n\t\\0~é\x07"), max_size=60))
def test_whatever_the_text_raises_only_treeerror(tmp_path: Path, text: str) -> None:
    with contextlib.suppress(TreeError):
        check_tree(write(tmp_path, "bt: 1\n" + text), REGISTRY)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(position=st.integers(0, len(SEARCH) - 1), char=st.sampled_from(":{}[]$-' \nx0"))
def test_a_mistyped_example_only_raises_treeerror(tmp_path: Path, position: int, char: str) -> None:
    write(tmp_path, SAFETY, "safety.yaml")
    with contextlib.suppress(TreeError):
        check_tree(write(tmp_path, SEARCH[:position] + char + SEARCH[position + 1 :]), REGISTRY)
