from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.pan_tilt.trajectory import Trajectory
from zavis_bt.types import PanTiltSpec

RATE, ACCELERATION, JERK, DT = 1.5, 3.0, 30.0, 0.02
SPEC = PanTiltSpec(-3, 3, -1, 1, RATE, ACCELERATION)
angles = st.tuples(st.floats(-3, 3), st.floats(-1, 1))


def run(trajectory: Trajectory, limit: int = 2000) -> list[tuple[float, float]]:
    """Set-points until the end."""
    points = [trajectory.position]
    while not trajectory.done:
        points.append(trajectory.step())
        assert len(points) < limit
    return points


def check_bounds(points: list[tuple[float, float]]) -> None:
    places = np.array(points)
    speeds = np.diff(places, axis=0) / DT
    accelerations = np.diff(speeds, axis=0) / DT
    jerks = np.diff(accelerations, axis=0) / DT
    assert np.abs(speeds).max(initial=0) <= RATE * (1 + 1e-6)
    assert np.abs(accelerations).max(initial=0) <= ACCELERATION * (1 + 1e-6)
    assert np.abs(jerks).max(initial=0) <= JERK * (1 + 1e-3)


@settings(max_examples=40)
@given(angles, angles)
def test_a_move_keeps_rate_acceleration_and_jerk_and_ends_at_the_target(
    start: tuple[float, float], target: tuple[float, float]
) -> None:
    trajectory = Trajectory(SPEC, JERK, DT)
    trajectory.hold(start)
    trajectory.go_to(target)
    points = run(trajectory)
    check_bounds(points)
    assert points[-1] == pytest.approx(target, abs=1e-9)


@settings(max_examples=40)
@given(st.lists(st.tuples(angles, st.integers(1, 60)), min_size=2, max_size=6))
def test_new_targets_on_the_way_break_no_limit(targets: list[tuple[tuple[float, float], int]]) -> None:
    trajectory = Trajectory(SPEC, JERK, DT)
    points = [trajectory.position]
    for target, steps in targets:
        trajectory.go_to(target)
        points += [trajectory.step() for _ in range(steps)]
    check_bounds(points + run(trajectory)[1:])


def test_both_axes_arrive_in_the_same_cycle() -> None:
    trajectory = Trajectory(SPEC, JERK, DT)
    trajectory.go_to((2.5, 0.1))
    places = np.array(run(trajectory))
    arrived = [int(np.argmax(np.abs(places[:, axis] - places[-1, axis]) < 1e-6)) for axis in (0, 1)]
    assert abs(arrived[0] - arrived[1]) <= 2


def test_a_halt_comes_to_rest_soon_and_keeps_the_limits() -> None:
    trajectory = Trajectory(SPEC, JERK, DT)
    trajectory.go_to((2.5, -0.9))
    points = [trajectory.position] + [trajectory.step() for _ in range(45)]
    trajectory.halt()
    rest = run(trajectory)[1:]
    check_bounds(points + rest)
    # Braking from full rate takes rate / acceleration, and the build-up of the deceleration.
    assert len(rest) * DT <= RATE / ACCELERATION + 2 * ACCELERATION / JERK + 2 * DT
    assert trajectory.position[0] < 2.4


def test_a_halt_at_rest_changes_nothing() -> None:
    trajectory = Trajectory(SPEC, JERK, DT)
    trajectory.hold((0.3, 0.2))
    trajectory.halt()
    assert trajectory.step() == (0.3, 0.2)
    assert trajectory.done
