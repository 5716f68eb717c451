"""Guard, for_each, reactive_selector, recovery, parallel: who runs when, and that nothing overlaps."""

from __future__ import annotations

from pathlib import Path

import pytest
from tree_kinds import REGISTRY, Bench, Consume, bench, tree_text, write

from zavis_bt.errors import TreeError
from zavis_bt.tree import Behaviour, Registry, Status, load_tree

GUARD = """
guard:
  while: [{flag: {name_of: a}}]
  do: {act: {ticks: 99, label: do}}
  else: {act: {ticks: 3, label: else}}
"""


def running_at_once(events: list[str]) -> int:
    """Return how many actions ran at the same time at most."""
    running: set[str] = set()
    most = 0
    for event in events:
        verb, name = event.split()[:2]
        running = running | {name} if verb == "start" else running - {name}
        most = max(most, len(running))
    return most


def test_guard_stops_do_before_else_starts(tmp_path: Path) -> None:
    guard = bench(tmp_path, GUARD)
    guard.tick(2)
    guard.flags["a"] = False
    guard.tick()
    assert guard.log.events == ["start do", "stop do INVALID", "start else"]
    assert guard.tree.nodes()[1].reason == "flag: a is down"


def test_guard_goes_back_when_the_condition_holds_again(tmp_path: Path) -> None:
    guard = bench(tmp_path, GUARD)
    guard.flags["a"] = False
    guard.tick()
    guard.flags["a"] = True
    guard.tick()
    assert guard.log.events == ["start else", "stop else INVALID", "start do"]
    assert running_at_once(guard.log.events) == 1


def test_guard_ends_as_its_branch_does(tmp_path: Path) -> None:
    guard = bench(tmp_path, GUARD)
    guard.flags["a"] = False
    assert guard.tick(3) is Status.SUCCESS
    failing = bench(tmp_path, "guard: {while: [scan], do: {fail: no}, else: scan}")
    assert failing.tick() is Status.FAILURE
    assert failing.tree.reason == "no"


def test_guard_without_else_fails_with_the_conditions_reason(tmp_path: Path) -> None:
    guard = bench(tmp_path, "guard: {while: [{flag: {name_of: a}}], do: {act: {ticks: 9}}}")
    guard.tick()
    guard.flags["a"] = False
    assert guard.tick() is Status.FAILURE
    failure = guard.tree.failure()
    assert failure is not None
    assert (failure.id, failure.reason) == ("main/guard.while.0/flag", "a is down")
    assert guard.log.events == ["start act", "stop act INVALID"]


def test_guard_checks_conditions_in_order_up_to_the_first_that_fails(tmp_path: Path) -> None:
    both = "[{flag: {name_of: a}}, {flag: {name_of: b}}]"
    guard = bench(tmp_path, f"guard: {{while: {both}, do: {{act: {{ticks: 9}}}}}}")
    guard.flags.update(a=False, b=False)
    guard.tick()
    assert [state.status.value for state in guard.tree.nodes()[2:]] == ["FAILURE", "INVALID", "INVALID"]


LOOP = "sequence: [{{produce: {{}}, save: {{numbers: n}}}}, {{for_each: {{items: $n, as: i, until: {}}}, do: {}}}]"


@pytest.mark.parametrize(
    ("until", "wanted", "status", "seen"),
    [
        ("success", 1, Status.SUCCESS, [0.0, 1.0]),
        ("success", 9, Status.FAILURE, [0.0, 1.0, 2.0]),
        ("failure", 0, Status.SUCCESS, [0.0, 1.0, 2.0]),
        ("failure", 1, Status.FAILURE, [0.0]),
        ("all", 1, Status.SUCCESS, [0.0, 1.0, 2.0]),
    ],
)
def test_for_each_ends_as_until_says(
    tmp_path: Path, until: str, wanted: int, status: Status, seen: list[float]
) -> None:
    do = f"{{consume: {{value: $i, wanted: {wanted}}}}}"
    loop = bench(tmp_path, "{" + LOOP.format(until, do) + "}")
    assert loop.to_the_end() is status
    assert next(node for node in loop.tree.root.iterate() if isinstance(node, Consume)).seen == seen


@pytest.mark.parametrize(("until", "status"), [("success", "FAILURE"), ("failure", "SUCCESS"), ("all", "SUCCESS")])
def test_for_each_of_nothing_ends_at_once_without_ticking(tmp_path: Path, until: str, status: str) -> None:
    loop = bench(tmp_path, f"{{for_each: {{items: [], as: i, until: {until}}}, do: act}}")
    assert loop.tick().name == status
    assert loop.log.events == []
    assert loop.tree.reason == "nothing to do"


def test_for_each_gives_null_items_too(tmp_path: Path) -> None:
    loop = bench(tmp_path, "{for_each: {items: [1, null, 3], as: i, until: all}, do: {when: $i == null}}")
    assert loop.tick(2) is Status.RUNNING
    assert loop.tick() is Status.SUCCESS


def test_for_each_stops_its_child_when_it_is_stopped(tmp_path: Path) -> None:
    loop = bench(tmp_path, "{for_each: {items: [1, 2], as: i}, do: {act: {ticks: 5}}}")
    loop.tick()
    loop.tree.stop()
    assert loop.log.events == ["start act", "stop act INVALID"]


def test_loops_nest(tmp_path: Path) -> None:
    text = """
for_each: {items: [1, 2], as: i}
do:
  for_each: {items: [3, 4], as: j}
  do: {act: {}}
"""
    loop = bench(tmp_path, text)
    assert loop.to_the_end() is Status.SUCCESS
    assert loop.log.events.count("start act") == 4


PREEMPT = """
reactive_selector:
  - sequence:
      - flag: {name_of: a}
      - act: {ticks: 5, label: high}
  - act: {ticks: 99, label: low}
"""


def test_a_reactive_selector_stops_the_old_action_before_the_new_one_starts(tmp_path: Path) -> None:
    selector = bench(tmp_path, PREEMPT)
    selector.flags["a"] = False
    selector.tick(2)
    selector.flags["a"] = True
    selector.tick()
    assert selector.log.events == ["start low", "stop low INVALID", "start high"]
    selector.flags["a"] = False
    selector.tick(1)
    assert selector.tree.status is Status.RUNNING


def test_conditions_do_not_disturb_what_runs(tmp_path: Path) -> None:
    selector = bench(tmp_path, PREEMPT)
    selector.flags["a"] = False
    selector.tick(5)
    assert selector.log.events == ["start low"]


def test_an_action_that_fails_at_once_disturbs_what_runs_only_once(tmp_path: Path) -> None:
    text = "reactive_selector: [{act: {ends: failure, label: probe}}, {act: {ticks: 99, label: low}}]"
    selector = bench(tmp_path, text)
    selector.tick(6)
    assert selector.log.events.count("stop low INVALID") == 1
    assert selector.tree.status is Status.RUNNING


def test_a_reactive_sequence_starts_over_and_a_sequence_keeps_its_place(tmp_path: Path) -> None:
    counts = {}
    for kind in ("sequence", "reactive_sequence"):
        sequence = bench(tmp_path, f"{kind}: [{{act: {{label: first}}}}, {{act: {{ticks: 3, label: last}}}}]")
        assert sequence.tick(3) is Status.SUCCESS
        counts[kind] = sequence.log.events.count("start first")
    assert counts == {"sequence": 1, "reactive_sequence": 3}


def test_recover_runs_between_attempts_only(tmp_path: Path) -> None:
    tree = bench(tmp_path, "{act: {ends: failure, label: try}, retry: 3, recover: {act: {ticks: 2, label: fix}}}")
    assert tree.to_the_end() is Status.FAILURE
    starts = [event.split()[1] for event in tree.log.events if event.startswith("start")]
    assert starts == ["try", "fix", "try", "fix", "try"]
    assert tree.tree.reason == "try failed"


def test_a_failing_recovery_does_not_end_the_attempts(tmp_path: Path) -> None:
    tree = bench(tmp_path, "{act: {ends: failure}, retry: 2, recover: {fail: cannot}}")
    tree.to_the_end()
    assert tree.log.events.count("start act") == 2


def test_retry_and_timeout_beside_a_node_mean_a_time_for_each_attempt(tmp_path: Path) -> None:
    tree = bench(tmp_path, "{act: {ticks: 99}, timeout: 0.25, retry: 2}")
    assert tree.to_the_end() is Status.FAILURE
    assert tree.log.events == ["start act", "stop act INVALID"] * 2
    assert tree.tree.reason == "timed out after 0.25 s"


@pytest.mark.parametrize(("until", "ticks"), [("all", 4), ("any", 2), ("[slow]", 4), ("[act]", 2), ("slow", 4)])
def test_parallel_ends_as_until_says(tmp_path: Path, until: str, ticks: int) -> None:
    nodes = "[{act: {ticks: 4}, name: slow, timeout: 60}, {act: {ticks: 2, label: fast}}]"
    tree = bench(tmp_path, f"parallel: {{until: {until}, do: {nodes}}}")
    # Without synchronisation a child that has ended begins anew, so all end together only at a common multiple.
    assert tree.tick(ticks - 1) is Status.RUNNING
    assert tree.tick() is Status.SUCCESS


def test_parallel_fails_with_the_first_failure_and_stops_the_others(tmp_path: Path) -> None:
    tree = bench(tmp_path, "parallel: {do: [{act: {ticks: 9, label: x}}, {act: {ticks: 2, ends: failure, label: y}}]}")
    assert tree.tick(2) is Status.FAILURE
    assert "stop x INVALID" in tree.log.events
    assert tree.tree.reason == "y failed"


def test_parallel_until_an_unknown_child_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, tree_text("parallel: {until: [scna], do: [scan, go_home]}"))
    with pytest.raises(TreeError, match=r"no child of this parallel is called 'scna' \(did you mean 'scan'"):
        load_tree(path, REGISTRY)


def test_force_and_invert(tmp_path: Path) -> None:
    for text, status in (
        ("force_success: {fail: x}", Status.SUCCESS),
        ("force_failure: scan", Status.FAILURE),
        ("invert: {fail: x}", Status.SUCCESS),
        ("invert: scan", Status.FAILURE),
        ("{succeed: fine, repeat: 3}", Status.SUCCESS),
    ):
        assert bench(tmp_path, text).to_the_end() is status


def test_set_and_when(tmp_path: Path) -> None:
    text = """
sequence:
  - set: {round: 1, name_of: mug}
  - selector:
      - {fail: unseen, when: $round > 3}
      - set: {round: 4}
  - fail: $name_of
    when: $round == 4 and $name_of == "mug"
"""
    tree = bench(tmp_path, text)
    assert tree.to_the_end() is Status.FAILURE
    assert tree.tree.reason == "mug"


def test_when_is_checked_at_the_start_only(tmp_path: Path) -> None:
    text = "sequence: [{set: {x: 1}}, {parallel: {do: [{act: {ticks: 3}, when: $x == 1}, {set: {x: 2}}]}}]"
    tree = bench(tmp_path, text)
    tree.tick(2)
    assert tree.log.events == ["start act"]


def test_wait_takes_the_missions_time(tmp_path: Path) -> None:
    tree = bench(tmp_path, "wait: 0.3")
    assert tree.tick(3) is Status.RUNNING
    assert tree.tick() is Status.SUCCESS


def test_a_list_that_was_never_written_is_a_failure_with_reason(tmp_path: Path) -> None:
    class Silent(Behaviour):
        """Succeeds without writing its output."""

        from zavis_bt.tree import Out

        numbers = Out(list[int], "never written")

        def update(self) -> Status:
            return self.succeed()

    text = "sequence: [{silent: {}, save: {numbers: n}}, {for_each: {items: $n, as: i}, do: {consume: {value: $i}}}]"
    path = write(tmp_path, tree_text("{" + text + "}"))
    tree = Bench(load_tree(path, Registry([Silent, Consume])))
    assert tree.tick() is Status.FAILURE
    assert tree.tree.reason == "$n is read, but nothing has written it yet"
