from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.pan_tilt import SimPanTilt
from sim.trapezoid import fastest
from zavis_bt.types import PanTiltSpec

SPEC = PanTiltSpec(-2.0, 2.0, -0.8, 0.5, 1.5, 4.0)


@given(st.floats(-3, 3), st.floats(-1, 1), st.floats(-3, 3), st.floats(1.0, 3.0), st.floats(0.5, 9.0))
def test_a_trapezoid_keeps_rate_and_acceleration_and_ends_at_rest_at_the_target(
    start: float, speed: float, target: float, rate: float, acceleration: float
) -> None:
    move = fastest(start, speed, target, rate, acceleration)
    assert move.at(0.0) == pytest.approx((start, speed), abs=1e-6)
    assert move.at(move.duration) == (target, 0.0)
    times = np.linspace(0, move.duration, 400)
    positions, speeds = np.array([move.at(time) for time in times]).T
    dt = times[1] or 1.0
    assert np.abs(speeds).max() <= rate + 1e-6
    assert np.abs(np.diff(speeds)).max() <= acceleration * dt + 1e-6
    np.testing.assert_allclose(
        np.diff(positions), (speeds[1:] + speeds[:-1]) / 2 * dt, atol=acceleration * dt**2 + 1e-6
    )


def test_a_long_move_takes_the_least_time() -> None:
    # Speeding up and slowing down take 0.5 s and cover 0.25 each; 2.5 is left at 1.
    assert fastest(0.0, 0.0, 3.0, 1.0, 2.0).duration == pytest.approx(0.5 + 2.5 + 0.5)
    assert fastest(0.0, 0.0, 0.5, 1.0, 2.0).duration == pytest.approx(2 * math.sqrt(0.5 / 2.0))


@pytest.fixture
def time() -> SimpleNamespace:
    return SimpleNamespace(now=0.0)


@pytest.fixture
def unit(time: SimpleNamespace) -> SimPanTilt:
    return SimPanTilt(time, SPEC, memory=0.5)


def test_the_unit_begins_settled_and_straight_ahead(unit: SimPanTilt) -> None:
    state = unit.state()
    assert (state.pan, state.tilt, state.settled) == (0.0, 0.0, True)


def test_a_move_is_settled_when_both_axes_have_arrived(unit: SimPanTilt, time: SimpleNamespace) -> None:
    unit.move_to(1.0, -0.2)
    assert not unit.state().settled
    time.now = 0.5
    assert 0 < unit.state().pan < 1
    time.now = 2.0
    state = unit.state()
    assert (state.pan, state.tilt, state.settled, state.stamp) == (1.0, -0.2, True, 2.0)


def test_targets_are_clipped_to_the_limits(unit: SimPanTilt, time: SimpleNamespace) -> None:
    unit.move_to(9.0, -9.0)
    time.now = 10.0
    state = unit.state()
    assert (state.pan, state.tilt, state.settled) == (2.0, -0.8, True)


def test_asking_again_for_the_same_target_does_not_restart_the_move(unit: SimPanTilt, time: SimpleNamespace) -> None:
    unit.move_to(1.0, 0.0)
    for tick in range(40):
        time.now = tick * 0.05
        unit.move_to(1.0, 0.0)
    time.now = 2.0
    assert unit.state().settled


def test_stop_brakes_and_stays(unit: SimPanTilt, time: SimpleNamespace) -> None:
    unit.move_to(2.0, 0.0)
    time.now = 0.6
    before = unit.state().pan
    unit.stop()
    time.now = 5.0
    state = unit.state()
    assert state.settled
    assert before < state.pan <= before + 1.5**2 / (2 * 4.0) + 1e-9
    unit.stop()
    assert unit.state().pan == pytest.approx(state.pan)


def test_past_angles_are_known_within_the_memory(unit: SimPanTilt, time: SimpleNamespace) -> None:
    seen = {}
    for tick in range(60):
        time.now = tick * 0.1
        if tick % 3 == 0:
            unit.move_to(math.sin(tick), 0.3 * math.cos(tick))
        seen[time.now] = unit.state()
        for ago in range(min(tick, 5)):
            then = (tick - ago) * 0.1
            assert unit.angles_at(then) == pytest.approx((seen[then].pan, seen[then].tilt), abs=1e-12)
