"""The loop: rate, ends, pause, reload, containment."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from tree_kinds import Bench, bench

from zavis_bt.errors import DeviceError, TreeError
from zavis_bt.tree import Outcome, Runner, Status, Tree


def at_tick(runner: Callable[[], Runner], number: int, action: Callable[[], None]) -> Callable[[], None]:
    """Return a hook that acts once, when the runner has made so many ticks."""
    done: list[int] = []

    def hook() -> None:
        if runner().ticks >= number and not done:
            done.append(number)
            action()

    return hook


def test_a_run_ends_with_the_root(tmp_path: Path) -> None:
    mission = bench(tmp_path, "sequence: [{act: {ticks: 3}}, {fail: over}]")
    runner = Runner(mission.tree, mission.clock, rate=10.0)
    assert runner.run() == Outcome(Status.FAILURE, "over", "main/sequence.1/fail")
    assert (runner.ticks, runner.overruns) == (3, 0)
    assert mission.clock.time == pytest.approx(0.2)


def test_ticks_come_at_the_rate_without_drift(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 1001}")
    mission.clock.time = 5.0
    stamps: list[float] = []
    Runner(mission.tree, mission.clock, rate=30.0, before=[lambda: stamps.append(mission.clock.time)]).run()
    assert stamps[-1] == 5.0 + 1000 * (1 / 30.0)


def test_hooks_stand_around_the_tick(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 2}")
    events = mission.log.events
    before, after, on_exit = ([partial(events.append, name)] for name in ("before", "after", "on_exit"))
    Runner(mission.tree, mission.clock, before=before, after=after, on_exit=on_exit).run()
    turn = ["before", "after"]
    assert [event for event in events if event in ("before", "after", "on_exit")] == [*turn, *turn, "on_exit"]
    assert events.index("before") < events.index("start act") < events.index("after")


def test_overruns_are_counted_and_not_made_up_for(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 4}")
    stamps: list[float] = []

    def slow() -> None:
        stamps.append(round(mission.clock.time, 3))
        if len(stamps) == 2:
            mission.clock.time += 0.35

    runner = Runner(mission.tree, mission.clock, rate=10.0, before=[slow])
    runner.run()
    assert stamps == [0.0, 0.1, 0.5, 0.6]
    assert runner.overruns == 3


def test_stop_from_another_thread_ends_the_run(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 1000000}")
    runner = Runner(mission.tree, mission.clock)
    thread = threading.Timer(0.02, runner.stop, ["enough"])
    thread.start()
    assert runner.run() == Outcome(Status.INVALID, "enough", "")
    thread.join()
    assert mission.log.events == ["start act", "stop act INVALID"]


def test_the_first_reason_to_stop_counts(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 9}")
    runner = Runner(mission.tree, mission.clock)
    runner.stop("first")
    runner.stop("second")
    assert runner.run().reason == "first"
    assert mission.log.events == []


def test_a_pause_holds_the_tree_while_time_and_hooks_go_on(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 4}")
    turns: list[tuple[int, bool]] = []
    halted: list[float] = []

    def after() -> None:
        turns.append((runner.ticks, runner.paused))
        if len(turns) == 2:
            runner.pause()
        if len(turns) == 5:
            runner.resume()

    runner = Runner(mission.tree, mission.clock, after=[after], on_pause=lambda: halted.append(mission.clock.time))
    assert runner.run().status is Status.SUCCESS
    assert [ticks for ticks, _ in turns] == [1, 2, 2, 2, 2, 3, 4]
    assert halted == [pytest.approx(0.2)]
    assert mission.log.events == ["start act", "stop act SUCCESS"]


def test_a_reload_happens_between_ticks_and_stops_the_old_tree_first(tmp_path: Path) -> None:
    old = bench(tmp_path, "act: {ticks: 99, label: old}")

    def reload() -> Tree:
        new = bench(tmp_path, "act: {ticks: 2, label: new}")
        new.tree.setup({"clock": old.clock, "log": old.log, "flags": old.flags})
        return new.tree

    request = at_tick(lambda: runner, 3, lambda: runner.request_reload(reload))
    runner = Runner(old.tree, old.clock, after=[request])
    assert runner.run().status is Status.SUCCESS
    assert runner.tree is not old.tree
    assert [state.id for state in runner.tree.nodes()] == [state.id for state in old.tree.nodes()]
    assert old.log.events == ["start old", "stop old INVALID", "start new", "stop new SUCCESS"]


def test_a_reload_that_changes_only_comments_disturbs_nothing(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 5}")
    again = bench(tmp_path, "act: {  ticks: 5  }   # five")
    runner = Runner(mission.tree, mission.clock)
    runner.request_reload(lambda: again.tree)
    assert runner.run().status is Status.SUCCESS
    assert runner.tree is mission.tree
    assert again.log.events == []


def test_a_faulty_reload_leaves_the_old_tree(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    mission = bench(tmp_path, "act: {ticks: 5}")

    def reload() -> Tree:
        raise TreeError("t.yaml:1:1: error[kind]: unknown kind 'x'")

    runner = Runner(mission.tree, mission.clock)
    runner.request_reload(reload)
    assert runner.run().status is Status.SUCCESS
    assert runner.tree is mission.tree
    assert "unknown kind 'x'" in caplog.text


@pytest.mark.parametrize(
    "error", [DeviceError("lidar: no answer"), KeyboardInterrupt(), SystemExit(1), ValueError("bug")]
)
@pytest.mark.parametrize("place", ["before", "after"])
def test_whatever_a_hook_raises_everything_is_stopped_first(tmp_path: Path, error: BaseException, place: str) -> None:
    mission = bench(tmp_path, "parallel: {do: [{act: {ticks: 99}}, {raise: {where: terminate}}]}")
    events = mission.log.events

    def hook() -> None:
        if mission.clock.time > 0.25:
            raise error

    def broken() -> None:
        raise OSError("disk full")

    hooks: dict[str, Any] = {place: [hook], "on_exit": [broken, partial(events.append, "exit")]}
    runner = Runner(mission.tree, mission.clock, **hooks)
    with pytest.raises(type(error)):
        runner.run()
    assert events == ["start act", "stop act INVALID", "exit"]


def test_a_raising_behaviour_fails_and_the_run_ends_in_order(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    mission = bench(tmp_path, "sequence: [raise]")
    with caplog.at_level(logging.ERROR):
        outcome = Runner(mission.tree, mission.clock).run()
    assert outcome == Outcome(Status.FAILURE, "ValueError: broken", "main/sequence.0/raise")
    assert "Traceback" in caplog.text


def test_two_missions_after_each_other_do_not_leak(tmp_path: Path) -> None:
    text = "sequence:\n  - produce: {count: 4}\n    save: {total: sum}\n  - consume: {value: $sum, wanted: 6}"

    def run() -> tuple[Bench, Outcome]:
        mission = bench(tmp_path, text)
        return mission, Runner(mission.tree, mission.clock).run()

    (first, one), (second, two) = run(), run()
    assert one == two
    assert first.tree.namespace != second.tree.namespace
    assert first.tree.variables == second.tree.variables


def test_a_hold_is_a_pause_that_somebody_else_decides(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 4}")
    turns: list[int] = []
    changes: list[str] = []
    runner = Runner(
        mission.tree,
        mission.clock,
        after=[lambda: turns.append(runner.ticks)],
        hold=lambda: 0.15 < mission.clock.time < 0.45,
        on_pause=lambda: changes.append(f"held after {runner.ticks}"),
        on_resume=lambda: changes.append(f"goes on after {runner.ticks}"),
    )
    assert runner.run().status is Status.SUCCESS
    assert turns == [1, 2, 2, 2, 2, 3, 4]
    assert changes == ["held after 2", "goes on after 2"]
    assert not runner.paused


def test_a_hold_inside_a_pause_changes_nothing_until_both_are_over(tmp_path: Path) -> None:
    mission = bench(tmp_path, "act: {ticks: 3}")
    changes: list[float] = []
    runner = Runner(
        mission.tree,
        mission.clock,
        after=[lambda: runner.pause() if mission.clock.time < 0.25 else runner.resume()],
        hold=lambda: 0.15 < mission.clock.time < 0.55,
        on_pause=lambda: changes.append(mission.clock.time),
        on_resume=lambda: changes.append(mission.clock.time),
    )
    assert runner.run().status is Status.SUCCESS
    assert changes == [pytest.approx(0.1), pytest.approx(0.6)]
