"""What every clock must do."""

from __future__ import annotations

import pytest
from conformance_room import MIDDLE, ROBOT, room

from sim import Simulation
from zavis_bt.mission.clock import WallClock
from zavis_bt.mission.robot_file import load_robot
from zavis_bt.protocols import Clock


@pytest.fixture(params=["lockstep", "real_time", "wall"])
def clock(request: pytest.FixtureRequest, tmp_path) -> Clock:
    if request.param == "wall":
        return WallClock()
    path = tmp_path / "conformance.robot.yaml"
    path.write_text(ROBOT, encoding="utf-8")
    return Simulation(room(), load_robot(path).spec, MIDDLE, real_time=request.param == "real_time").clock


def test_time_begins_at_zero(clock: Clock) -> None:
    assert 0 <= clock.now() < 1


def test_time_never_goes_back(clock: Clock) -> None:
    stamps = []
    for wait in range(10):
        stamps.append(clock.now())
        clock.wait_until(wait / 100)
    assert stamps == sorted(stamps)


def test_waiting_ends_when_the_time_has_come_and_soon_after(clock: Clock) -> None:
    for _ in range(5):
        stamp = clock.now() + 0.033
        clock.wait_until(stamp)
        assert stamp <= clock.now() < stamp + 1


def test_waiting_for_what_is_past_takes_no_time(clock: Clock) -> None:
    clock.wait_until(0.2)
    now = clock.now()
    for stamp in (0.1, -5.0, now):
        clock.wait_until(stamp)
    assert clock.now() - now < 0.1
