from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.camera.clock_offset import ClockOffset

delays = st.lists(st.floats(0.001, 0.5), min_size=1, max_size=30)


@settings(deadline=None)
@given(st.floats(-1e4, 1e4), delays)
def test_the_offset_is_wrong_by_the_least_delay(offset, delays):
    clock = ClockOffset(seconds=100.0)
    for number, delay in enumerate(delays):
        clock.add(number - offset, number + delay)
    assert clock(5.0) - 5.0 == pytest.approx(offset + min(delays), abs=1e-6)


def test_what_is_long_past_no_longer_counts():
    clock = ClockOffset(seconds=3.0)
    clock.add(0.0, 10.0)
    for second in range(1, 5):
        clock.add(second, 10.5 + second)
    assert clock(0.0) == 10.5


def test_without_messages_a_time_stays_as_it_is():
    assert ClockOffset()(7.0) == 7.0
