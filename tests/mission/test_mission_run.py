"""Whole missions in the built-in flat: how they end, what is stopped, and what their results say."""

from __future__ import annotations

from collections import Counter

import pytest
from flat_mission import SPEED, START, Flat, Watcher
from hypothesis import given
from hypothesis import strategies as st

from sim.world_file import load_world
from sim.worlds import resolve_world
from zavis_bt.cli.files import load_robot_spec, resolve_tree
from zavis_bt.cli.simulate import Choices, SimulatedMission
from zavis_bt.mission import MissionSettings, Task, spl
from zavis_bt.types import Event

# -- how a mission ends ----------------------------------------------------------------------------------------------


def test_a_tree_that_succeeds_ends_the_mission_with_its_reason(tmp_path):
    flat = Flat(tmp_path, "drive_and_look: {seconds: 0.5}")
    result = flat.mission.run()
    assert (result.success, result.reason) == (True, "arrived")
    assert (result.id, result.method, result.seed) == ("flat:mug", "own", 7)
    assert result.path_length == pytest.approx(flat.world.path_length, abs=0.03)
    assert flat.watcher.started == 1
    assert flat.watcher.results == [result]
    flat.assert_stopped()


def test_a_behaviour_that_raises_fails_the_mission_with_what_it_raised_and_everything_stops(tmp_path):
    flat = Flat(tmp_path, 'drive_and_look: {seconds: 0.5, ends: "the wheel came off"}')
    result = flat.mission.run()
    assert not result.success
    assert result.reason == "own/drive_and_look: ValueError: the wheel came off"
    assert flat.watcher.results == [result]
    assert max(flat.watcher.speeds) > 0
    flat.assert_stopped()


def test_the_tree_may_recover_from_a_behaviour_that_raised(tmp_path):
    node = 'selector: [{drive_and_look: {seconds: 0.2, ends: "lost"}}, {succeed: {reason: recovered}}]'
    result = Flat(tmp_path, node).mission.run()
    assert (result.success, result.reason) == (True, "recovered")


def test_an_observer_that_raises_is_dropped_and_the_mission_goes_on(tmp_path, caplog):
    def fail() -> None:
        raise OSError("the browser has gone")

    flat, broken, other = Flat(tmp_path, "drive_and_look: {seconds: 1.0}"), Watcher(at=3, act=fail), Watcher()
    flat.mission.observe(broken)
    flat.mission.observe(other)
    result = flat.mission.run()
    assert result.success
    assert (broken.ticks, broken.results) == (3, [])
    assert other.ticks == flat.watcher.ticks > 3
    assert other.results == [result]
    assert caplog.text.count("Watcher failed and is dropped") == 1


@pytest.mark.parametrize(
    ("error", "reason"), [(RuntimeError("no map"), "crash: RuntimeError: no map"), (KeyboardInterrupt(), "interrupted")]
)
def test_a_crash_is_raised_again_after_everything_was_stopped_and_told(tmp_path, monkeypatch, error, reason):
    flat = Flat(tmp_path, "drive_and_look")

    def crash(*_: object) -> None:
        if flat.watcher.ticks == 5:
            raise error

    monkeypatch.setattr(flat.mission._mapper, "update", crash)
    with pytest.raises(type(error)):
        flat.mission.run()
    (result,) = flat.watcher.results
    assert (result.success, result.reason) == (False, reason)
    assert result.sim_seconds == pytest.approx(0.5)
    flat.assert_stopped()


def test_the_travel_budget_ends_the_mission(tmp_path):
    flat = Flat(tmp_path, "drive_and_look", settings=MissionSettings(max_travel=0.1))
    result = flat.mission.run()
    assert (result.success, result.reason) == (False, "not found within 0.1 m of travel")
    assert 0.1 < result.path_length < 0.1 + 2 * SPEED * 0.1
    flat.assert_stopped()


def test_the_time_limit_ends_the_mission(tmp_path):
    flat = Flat(tmp_path, "wait: {seconds: 100}", settings=MissionSettings(max_seconds=2))
    result = flat.mission.run()
    assert (result.success, result.reason) == (False, "not found within 2 s")
    assert result.sim_seconds == pytest.approx(2.0, abs=0.21)
    assert result.path_length == 0.0


def test_a_success_in_the_tick_that_exceeds_the_budget_counts(tmp_path):
    flat = Flat(tmp_path, "drive_and_look: {seconds: 1.0}", settings=MissionSettings(max_seconds=0.95))
    assert flat.mission.run().success


def test_stopping_from_outside_ends_the_mission_with_the_reason_given(tmp_path):
    flat = Flat(tmp_path, "drive_and_look")
    flat.watcher.at, flat.watcher.act = 4, lambda: flat.mission.runner.stop("the operator has seen enough")
    result = flat.mission.run()
    assert (result.success, result.reason) == (False, "the operator has seen enough")
    flat.assert_stopped()


def test_a_pause_stops_the_base_and_resuming_goes_on_to_success(tmp_path):
    flat = Flat(tmp_path, "drive_and_look: {seconds: 4.0}")
    flat.watcher.at, flat.watcher.act = 8, flat.mission.runner.pause
    flat.mission.observe(Watcher(at=20, act=flat.mission.runner.resume))
    result = flat.mission.run()
    assert result.success
    speeds = flat.watcher.speeds
    assert speeds[7] > 0
    assert set(speeds[12:20]) == {0.0}
    assert max(speeds[20:]) > 0


# -- what the result says --------------------------------------------------------------------------------------------


def test_the_result_counts_what_the_journal_was_told(tmp_path):
    flat = Flat(tmp_path, "report")
    result = flat.mission.run()
    assert (result.waypoints, result.candidates, result.confirmations) == (2, 2, 1)
    assert result.details == {"scans": 1, "frontiers": 1, "safety_stops": 0}
    assert flat.mission.viewpoints == ()
    assert len(flat.mission.visited) == 2


def test_a_searchs_result_agrees_with_its_events_and_the_simulation():
    choices = Choices(resolve_tree("search"), load_robot_spec("locobot"), "search")
    mission = SimulatedMission(
        choices, load_world(resolve_world("flat")), START, "wallet", Task("flat:wallet", "search", 1, 2.0)
    )
    events: list[Event] = []
    mission.mission.observe(Watcher(), events.append)
    result = mission.run()
    counts = Counter(event.kind for event in events)
    assert (result.waypoints, result.confirmations) == (counts["visit"], counts["ask"])
    assert result.candidates == sum(len(e.data["candidates"]) for e in events if e.kind == "candidates")
    assert (result.details["scans"], result.details["frontiers"]) == (counts["scan"], counts["frontier"])
    assert result.details["collisions"] == mission.simulation.collisions == 0
    assert result.success == (counts["found"] == 1)
    assert [event.stamp for event in events] == sorted(event.stamp for event in events)
    assert result.path_length == pytest.approx(mission.simulation.path_length, rel=0.02, abs=0.02)
    assert result.spl == spl(result.success, result.path_length, 2.0)


@pytest.mark.parametrize(
    ("success", "path_length", "shortest", "expected"),
    [
        (True, 8.0, 4.0, 0.5),
        (True, 4.0, 4.0, 1.0),
        (True, 3.0, 4.0, 1.0),  # p < l: found from farther than l is computed for
        (True, 0.0, 0.0, 1.0),
        (True, 5.0, 0.0, 1.0),  # l = 0: the target was in view at the start
        (False, 4.0, 4.0, 0.0),
        (False, 0.0, 0.0, 0.0),
    ],
)
def test_spl_is_success_times_shortest_over_driven(success, path_length, shortest, expected):
    assert spl(success, path_length, shortest) == expected


@given(driven=st.floats(0, 1e3), detour=st.floats(0, 1e3), shortest=st.floats(0, 1e3))
def test_spl_is_a_share_that_falls_with_the_way_driven(driven, detour, shortest):
    assert 0.0 <= spl(True, driven + detour, shortest) <= spl(True, driven, shortest) <= 1.0


def test_without_a_shortest_path_there_is_no_spl(tmp_path):
    assert Flat(tmp_path, "succeed").mission.run().spl is None
    assert Flat(tmp_path, "succeed", shortest=3.0).mission.run().spl == 1.0
    assert Flat(tmp_path, "fail: {reason: no}", shortest=3.0).mission.run().spl == 0.0
