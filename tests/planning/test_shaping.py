from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from zavis_bt.planning.shaping import TwistShaper
from zavis_bt.types import BaseLimits, Twist2D

LIMITS = BaseLimits(0.7, 0.4, 2.4, 0.3, 1.7)
RATIO = 8.0
TINY = 1e-9

twists = st.builds(Twist2D, st.floats(-2, 2), st.floats(-5, 5))
steps = st.lists(st.tuples(twists, st.floats(0.005, 0.3)), min_size=1, max_size=60)


def clipped(twist: Twist2D) -> Twist2D:
    return Twist2D(min(max(twist.linear, -0.4), 0.7), min(max(twist.angular, -2.4), 2.4))


@given(steps)
def test_velocity_and_acceleration_keep_to_the_limits_whatever_is_commanded(steps: list[tuple[Twist2D, float]]) -> None:
    shaper, before = TwistShaper(LIMITS, RATIO), Twist2D()
    for command, dt in steps:
        now = shaper.shape(command, dt)
        assert now == clipped(now)
        assert abs(now.linear - before.linear) <= 0.3 * dt + TINY
        assert abs(now.angular - before.angular) <= 1.7 * dt + TINY
        before = now


@given(steps)
def test_the_acceleration_changes_no_faster_than_the_jerk_allows(steps: list[tuple[Twist2D, float]]) -> None:
    shaper, dt = TwistShaper(LIMITS, RATIO), 0.02
    before, change = Twist2D(), 0.0
    for command, _ in steps:
        now = shaper.shape(command, dt)
        assert abs((now.linear - before.linear) - change) <= RATIO * 0.3 * dt * dt + TINY
        before, change = now, now.linear - before.linear


@given(twists, twists, st.floats(0.05, 0.3))
def test_a_command_is_reached_exactly_without_overshoot(start: Twist2D, command: Twist2D, dt: float) -> None:
    shaper = TwistShaper(LIMITS, RATIO)
    shaper.reset(start)
    first, goal = clipped(start), clipped(command)
    seen = [shaper.shape(command, dt) for _ in range(int(8 / dt))]
    assert seen[-1].linear == pytest.approx(goal.linear, abs=TINY)
    assert seen[-1].angular == pytest.approx(goal.angular, abs=TINY)
    for axis in ("linear", "angular"):
        low, high = sorted((getattr(first, axis), getattr(goal, axis)))
        assert all(low - TINY <= getattr(twist, axis) <= high + TINY for twist in seen)


@given(twists)
def test_it_stops_at_exactly_zero(start: Twist2D) -> None:
    shaper = TwistShaper(LIMITS)
    shaper.reset(start)
    for _ in range(100):
        last = shaper.shape(Twist2D(), 0.1)
    assert last == Twist2D(0.0, 0.0)


def test_no_time_changes_nothing() -> None:
    shaper = TwistShaper(LIMITS)
    moving = shaper.shape(Twist2D(0.5, 0.0), 0.2)
    assert shaper.shape(Twist2D(), 0.0) == moving
