from __future__ import annotations

import math
from dataclasses import replace

import pytest
from scripted import Stage, viewpoint

from behaviours import Navigate
from zavis_bt.tree import Status
from zavis_bt.types import Pose2D, Twist2D


@pytest.mark.parametrize("goal", [Pose2D(2.0, 1.0, math.pi / 2), Pose2D(-1.5, -2.0, 0.0), viewpoint(1.5, -1.0)])
def test_it_stops_at_the_goal_facing_as_asked(stage, goal):
    navigate = stage.setup(Navigate(goal=goal, tolerance=0.15, yaw_tolerance=0.2))
    assert stage.run(navigate) is Status.SUCCESS
    pose, wanted = stage.robot.base_state.pose, getattr(goal, "pose", goal)
    assert pose.distance(wanted) <= 0.2
    assert abs(math.remainder(pose.yaw - wanted.yaw, math.tau)) <= 0.3
    assert stage.robot.twist == Twist2D()


def test_the_reported_length_is_what_was_driven(stage):
    navigate = stage.setup(Navigate(goal=Pose2D(2.0, 0.0), yaw_tolerance=4.0))
    stage.run(navigate)
    assert navigate.path_length == pytest.approx(stage.robot.base_state.pose.x, abs=0.1)


def test_a_goal_behind_the_wall_is_unreachable_and_nothing_moves(stage):
    navigate = stage.setup(Navigate(goal=Pose2D(5.0, 0.0)))
    assert stage.run(navigate) is Status.FAILURE
    assert "unreachable" in navigate.feedback_message
    assert stage.robot.base_state.pose == Pose2D(0.0, 0.0)


def test_a_base_that_does_not_move_is_stuck():
    stage = Stage()
    stage.robot.held = True
    navigate = stage.setup(Navigate(goal=Pose2D(2.0, 0.0)))
    assert stage.run(navigate) is Status.FAILURE
    assert navigate.feedback_message in ("stuck", "blocked")
    assert stage.robot.twist == Twist2D()


def test_stopping_half_way_stops_the_base_and_clears_the_shown_path(stage):
    navigate = stage.setup(Navigate(goal=Pose2D(2.0, 0.0)))
    for _ in range(10):
        stage.tick(navigate)
    assert stage.journal.path is not None
    navigate.stop(Status.INVALID)
    assert stage.robot.twist == Twist2D()
    assert stage.journal.path is None


def press_bumper(stage: Stage, pressed: bool) -> None:
    stage.robot.base_state = replace(stage.robot.base_state, bumper=pressed)


def test_a_base_that_runs_into_something_moves_away_from_it_and_goes_on(stage):
    navigate = stage.setup(Navigate(goal=Pose2D(2.0, 0.0), yaw_tolerance=4.0))
    while stage.robot.base_state.pose.x < 0.8:
        stage.tick(navigate)
    press_bumper(stage, True)
    met = stage.robot.base_state.pose.x
    while met - stage.robot.base_state.pose.x < 0.05:
        assert stage.tick(navigate) is Status.RUNNING
        assert stage.robot.twist.linear <= 0.0
    press_bumper(stage, False)
    assert stage.run(navigate) is Status.SUCCESS


def test_a_base_that_cannot_get_free_does_not_try_for_ever(stage):
    navigate = stage.setup(Navigate(goal=Pose2D(2.0, 0.0)))
    for _ in range(10):
        stage.tick(navigate)
    press_bumper(stage, True)
    stage.robot.held = True
    assert stage.run(navigate) is Status.FAILURE
    assert stage.robot.twist == Twist2D()
