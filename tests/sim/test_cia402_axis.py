from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.devices.cia402.axis import Axis, Ramp

numbers = st.floats(-100, 100)


@settings(max_examples=40)
@given(numbers, numbers, numbers, st.floats(1, 50), st.floats(0.1, 5))
def test_a_ramp_keeps_its_acceleration_and_comes_to_rest(
    start: float, speed: float, target: float, acceleration: float, hold: float
) -> None:
    ramp = Ramp(start, speed, target, acceleration, hold)
    assert ramp.at(0.0) == pytest.approx((start, speed))
    times = np.linspace(0, hold + 200 / acceleration, 2000)
    places, speeds = np.array([ramp.at(time) for time in times]).T
    dt = times[1]
    assert np.abs(np.diff(speeds)).max() <= acceleration * dt + 1e-6
    np.testing.assert_allclose(np.diff(places), (speeds[1:] + speeds[:-1]) / 2 * dt, atol=acceleration * dt**2 + 1e-6)
    assert speeds[-1] == 0


def test_the_past_is_remembered_when_a_new_motion_begins() -> None:
    axis = Axis(-100, 100, 0.0)
    axis.run(1.0, 10.0, 1000.0)
    then = axis.at(1.5)
    axis.go_to(2.0, 50.0, 20.0, 100.0)
    assert axis.at(1.5) == then
    assert axis.at(0.5) == (0.0, 0.0)
    assert axis.at(60.0) == (50.0, 0.0)


def test_hard_stops_hold_the_shaft() -> None:
    axis = Axis(-5, 5, 0.0)
    axis.run(0.0, 10.0, 1000.0)
    assert axis.at(10.0) == (5.0, 0.0)
    axis.run(10.0, -10.0, 1000.0)
    assert axis.at(10.5)[0] < 1
