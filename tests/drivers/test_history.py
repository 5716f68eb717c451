from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.history import PoseHistory
from zavis_bt.types import Pose2D, Twist2D

STILL = Twist2D()


def test_without_a_measurement_it_is_the_origin():
    assert PoseHistory().at(1.0) == Pose2D(0.0, 0.0)


@given(st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-3.1, 3.1)), min_size=1, max_size=10))
def test_at_a_measurement_it_is_what_was_measured(poses):
    history = PoseHistory()
    for i, pose in enumerate(poses):
        history.add(i * 0.1, Pose2D(*pose), STILL)
    for i, (x, y, yaw) in enumerate(poses):
        pose = history.at(i * 0.1)
        assert (pose.x, pose.y) == pytest.approx((x, y))
        assert math.cos(pose.yaw - yaw) == pytest.approx(1.0)


def test_between_measurements_it_lies_on_the_line_and_turns_the_short_way():
    history = PoseHistory()
    history.add(0.0, Pose2D(0.0, 0.0, math.radians(170)), STILL)
    history.add(1.0, Pose2D(1.0, 2.0, math.radians(-170)), STILL)
    middle = history.at(0.5)
    assert (middle.x, middle.y) == pytest.approx((0.5, 1.0))
    assert abs(middle.yaw) == pytest.approx(math.pi)


def test_soon_after_the_last_measurement_the_motion_goes_on():
    history = PoseHistory()
    history.add(5.0, Pose2D(1.0, 1.0, math.pi / 2), Twist2D(0.5, 0.2))
    ahead = history.at(5.1)
    assert ahead.y == pytest.approx(1.05, abs=1e-3)
    assert ahead.yaw == pytest.approx(math.pi / 2 + 0.02)


def test_long_after_the_last_measurement_it_is_not_carried_on():
    history = PoseHistory()
    history.add(0.0, Pose2D(0.0, 0.0), Twist2D(0.5, 0.0))
    assert history.at(60.0).x < 0.2


def test_before_what_is_remembered_it_is_the_oldest():
    history = PoseHistory(seconds=1.0)
    for i in range(50):
        history.add(i * 0.1, Pose2D(float(i), 0.0), STILL)
    assert history.at(0.0).x >= 38.0
    assert len(history._entries) < 13
