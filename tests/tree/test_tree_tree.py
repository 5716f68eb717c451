"""A loaded tree: resources, stopping, states, failure, and that it leaves nothing behind."""

from __future__ import annotations

import gc
from pathlib import Path

import py_trees
import pytest
from py_trees.blackboard import Blackboard
from tree_kinds import REGISTRY, Bench, Log, bench, tree_text, write

from zavis_bt.errors import TreeError
from zavis_bt.tree import Behaviour, Registry, Status, load_tree
from zavis_bt.types import NodeStatus


def test_missing_resources_are_reported_with_node_and_name(tmp_path: Path) -> None:
    tree = load_tree(write(tmp_path, tree_text("sequence: [{act: {}, timeout: 3}, {flag: {name_of: a}}]")), REGISTRY)
    with pytest.raises(TreeError) as caught:
        tree.setup({"lock": Log()})
    lines = [line.partition("t.yaml:")[2] for line in str(caught.value).splitlines()]
    assert lines == [
        "6:19: error[resource]: 'act' needs the resource 'log' (one of: lock)",
        "6:28: error[resource]: 'timeout' needs the resource 'clock' (did you mean 'lock'?)",
        "6:42: error[resource]: 'flag' needs the resource 'flags' (one of: lock)",
    ]


def test_a_resource_with_a_default_is_optional(tmp_path: Path) -> None:
    class Relaxed(Behaviour):
        """Takes what there is."""

        def setup(self, *, log: Log | None = None, clock: object) -> None:
            self.taken = (log, clock)

        def update(self) -> Status:
            return self.succeed()

    tree = load_tree(write(tmp_path, tree_text("relaxed")), Registry([Relaxed]))
    tree.setup({"clock": 1, "other": 2})
    relaxed = next(node for node in tree.root.iterate() if isinstance(node, Relaxed))
    assert relaxed.taken == (None, 1)


def test_stop_stops_what_runs_and_does_nothing_twice(tmp_path: Path) -> None:
    tree = bench(tmp_path, "parallel: {do: [{act: {ticks: 9, label: x}}, {act: {ticks: 9, label: y}}]}")
    tree.tick()
    tree.tree.stop()
    tree.tree.stop()
    assert tree.log.events == ["start x", "start y", "stop x INVALID", "stop y INVALID"]
    assert tree.tree.status is Status.INVALID


def test_stop_keeps_the_states_of_a_tree_that_has_ended(tmp_path: Path) -> None:
    tree = bench(tmp_path, "fail: over")
    tree.tick()
    tree.tree.stop()
    assert (tree.tree.status, tree.tree.reason) == (Status.FAILURE, "over")


def test_what_a_cut_short_tick_began_is_stopped(tmp_path: Path) -> None:
    class Interrupt(Behaviour):
        """Ctrl-C while it works."""

        def update(self) -> Status:
            raise KeyboardInterrupt

    text = tree_text("sequence: [parallel: {do: [{act: {ticks: 9}}, interrupt]}]")
    tree = Bench(load_tree(write(tmp_path, text), Registry([*REGISTRY.values(), Interrupt])))
    with pytest.raises(KeyboardInterrupt):
        tree.tick()
    tree.tree.stop()
    assert tree.log.events == ["start act", "stop act INVALID"]


def test_a_fault_of_one_behaviour_leaves_the_tree_going(tmp_path: Path) -> None:
    for where in ("initialise", "update"):
        tree = bench(tmp_path, f"selector: [{{raise: {{where: {where}}}}}, {{act: {{ticks: 2}}}}]")
        assert tree.tick() is Status.RUNNING
        assert tree.tree.nodes()[2].reason == "ValueError: broken"


def test_a_fault_in_terminate_does_not_keep_others_running(tmp_path: Path) -> None:
    tree = bench(tmp_path, "parallel: {do: [{raise: {where: terminate}}, {act: {ticks: 9}}]}")
    tree.tick()
    tree.tree.stop()
    assert tree.log.events == ["start act", "stop act INVALID"]


def test_states_are_the_same_object_until_something_changes(tmp_path: Path) -> None:
    tree = bench(tmp_path, "act: {ticks: 3}").tree
    first, version = tree.nodes(), tree.version
    assert tree.nodes() is first
    tree.tick()
    assert tree.version > version
    assert [state.status for state in tree.nodes()] == [NodeStatus.RUNNING] * 2
    assert tree.nodes()[1].reason == "tick 1"


def test_failure_is_told_of_the_deepest_node_that_decided_it(tmp_path: Path) -> None:
    text = """
sequence:
  - act: {}
  - selector:
      - fail: first
      - sequence:
          - act: {}
          - {act: {ends: failure, label: gripper}, retry: 2, name: grip}
"""
    tree = bench(tmp_path, text)
    assert tree.tree.failure() is None
    tree.to_the_end()
    failure = tree.tree.failure()
    assert failure is not None
    assert failure.id == "main/sequence.1/selector.1/sequence.1/act"
    assert (failure.name, failure.reason) == ("grip", "gripper failed")


def test_an_inverted_success_is_named(tmp_path: Path) -> None:
    tree = bench(tmp_path, "invert: {succeed: there it was}")
    tree.tick()
    assert tree.tree.reason == "there it was"


def test_a_discarded_tree_leaves_nothing_on_the_blackboard(tmp_path: Path) -> None:
    gc.collect()
    clients, keys, metadata = len(Blackboard.clients), set(Blackboard.storage), set(Blackboard.metadata)
    text = "sequence:\n  - produce: {}\n    save: {total: sum}\n  - consume: {value: $sum}"
    tree = bench(tmp_path, text)
    tree.to_the_end()
    assert len(Blackboard.storage) > len(keys)
    del tree
    gc.collect()
    assert (len(Blackboard.clients), set(Blackboard.storage), set(Blackboard.metadata)) == (clients, keys, metadata)


def test_the_blackboard_knows_the_wires(tmp_path: Path) -> None:
    text = "sequence:\n  - produce: {}\n    save: {total: sum}\n  - consume: {value: $sum}"
    tree = bench(tmp_path, text).tree
    wired = [key for key in Blackboard.metadata if key.startswith(f"{tree.namespace}/") and key.endswith("/sum")]
    assert len(wired) == 1
    assert len(Blackboard.metadata[wired[0]].read) == len(Blackboard.metadata[wired[0]].write) == 1
    assert "produce" in py_trees.display.unicode_tree(tree.root)


def test_a_global_that_does_not_exist_cannot_be_written(tmp_path: Path) -> None:
    tree = bench(tmp_path, "scan", head="globals: {round: {type: int, default: 0}}\n").tree
    with pytest.raises(KeyError):
        tree.write("rond", 1)
    with pytest.raises(TypeError, match="takes int"):
        tree.write("round", "one")
