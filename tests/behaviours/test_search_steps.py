"""Look, detect, confirm, waypoints, frontier: each alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scripted import FixedPrior, ScriptedHuman, Stage, candidate, viewpoint

from behaviours import BackUp, Confirm, Detect, ForgetVisits, GenerateWaypoints, GoToFrontier, Look
from zavis_bt.tree import Status
from zavis_bt.types import Answer, LandmarkSighting, Pose2D


def put_landmark(stage: Stage, x: float, y: float, label: str) -> None:
    stage.mapper.semantic.integrate([LandmarkSighting(((label, 1.0),), (x, y, 0.7), 0.3, 0.9, stage.robot.time)])


def test_look_covers_the_landmarks_height_and_width(stage):
    view = viewpoint(0.0, 0.0)
    look = stage.setup(Look(at=view, low=0.2, high=1.2))
    assert stage.run(look) is Status.SUCCESS
    camera = stage.robot.spec.camera
    tilts = np.array([tilt for _, tilt in stage.robot.moves])
    half = camera.intrinsics.vertical_fov / 2
    assert tilts.max() + half >= math.atan2(1.2 - camera.height, 1.0)
    assert tilts.min() - half <= math.atan2(0.2 - camera.height, 1.0)
    assert len(look.frames) == len(stage.robot.moves)


def test_look_counts_as_a_visit_once_it_is_complete(stage):
    look = stage.setup(Look(at=viewpoint(landmark=7)))
    stage.tick(look)
    assert 7 not in stage.mapper.semantic.visited
    stage.run(look)
    assert 7 in stage.mapper.semantic.visited
    assert stage.journal.counts["visit"] == 1


def test_detect_without_frames_uses_the_cameras_latest(stage):
    stage.perceiver.targets = [(2.0, 0.0, 0.8)]
    detect = stage.setup(Detect(target="cup"))
    assert stage.run(detect) is Status.SUCCESS
    assert len(detect.candidates) == 1


def test_detect_fails_in_words_when_there_is_nothing(stage):
    detect = stage.setup(Detect(target="cup"))
    assert stage.run(detect) is Status.FAILURE
    assert detect.feedback_message == "not in sight"
    stage.robot.camera_works = False
    assert stage.run(stage.setup(detect)) is Status.FAILURE
    assert "no frame" in detect.feedback_message


@pytest.mark.parametrize(("accepted", "status"), [(1, Status.SUCCESS), (None, Status.FAILURE)])
def test_confirm_follows_the_person(accepted, status):
    stage = Stage(human=ScriptedHuman(Answer(accepted, "says the person"), delay=1.0))
    candidates = [candidate(position=(1.0, 0, 0)), candidate(position=(2.0, 0, 0))]
    confirm = stage.setup(Confirm(target="cup", candidates=candidates))
    assert stage.tick(confirm) is Status.RUNNING
    assert stage.run(confirm) is status
    assert confirm.feedback_message == "says the person"
    if accepted is not None:
        assert confirm.found is candidates[1]
        assert stage.journal.found is candidates[1]


def test_confirm_withdraws_the_question_when_it_is_stopped():
    stage = Stage(human=ScriptedHuman(Answer(0), delay=9.0))
    confirm = stage.setup(Confirm(target="cup", candidates=[candidate()]))
    stage.tick(confirm)
    confirm.stop(Status.INVALID)
    assert stage.human.withdrawn == 1


def test_confirm_without_candidates_asks_nobody(stage):
    confirm = stage.setup(Confirm(target="cup", candidates=[]))
    assert stage.run(confirm) is Status.FAILURE
    assert stage.human.asked == []


def test_waypoints_prefer_the_likely_landmark_over_the_near_one():
    stage = Stage(prior=FixedPrior(desk=0.9, bed=0.3))
    put_landmark(stage, 1.6, 0.0, "bed")
    put_landmark(stage, -2.2, 0.0, "desk")
    likely = stage.setup(GenerateWaypoints(target="cup", lambda_1=20.0))
    assert stage.run(likely) is Status.SUCCESS
    assert [view.label for view in likely.waypoints] == ["desk", "bed"]
    near = stage.setup(GenerateWaypoints(target="cup", order="nearest"))
    stage.run(near)
    assert [view.label for view in near.waypoints] == ["bed", "desk"]


def test_waypoints_leave_out_visited_and_unlikely_landmarks():
    stage = Stage(prior=FixedPrior(desk=0.9, bed=0.1))
    put_landmark(stage, 1.6, 0.0, "bed")
    put_landmark(stage, -2.2, 0.0, "desk")
    waypoints = stage.setup(GenerateWaypoints(target="cup"))
    stage.run(waypoints)
    assert [view.label for view in waypoints.waypoints] == ["desk"]
    stage.mapper.semantic.mark_visited(waypoints.waypoints[0].landmark)
    assert stage.run(waypoints) is Status.FAILURE
    assert waypoints.feedback_message == "no landmark likely"


def test_a_landmark_that_is_never_reached_is_given_up(stage):
    put_landmark(stage, 1.6, 0.0, "desk")
    waypoints = stage.setup(GenerateWaypoints(target="cup", tries=2))
    assert [stage.run(waypoints) for _ in range(3)] == [Status.SUCCESS, Status.SUCCESS, Status.FAILURE]


def test_viewpoints_face_their_landmark_from_free_space(stage):
    put_landmark(stage, 2.0, 1.0, "desk")
    waypoints = stage.setup(GenerateWaypoints(target="cup"))
    stage.run(waypoints)
    (view,) = waypoints.waypoints
    assert abs(view.pose.bearing(2.0, 1.0)) < 0.05
    assert max(abs(view.pose.x), abs(view.pose.y)) < 3.0 - 0.18


def test_forget_visits_makes_landmarks_eligible_again_for_so_many_rounds(stage):
    put_landmark(stage, 2.0, 1.0, "desk")
    (landmark,) = stage.mapper.semantic.landmarks
    forget = stage.setup(ForgetVisits(rounds=1))
    stage.mapper.semantic.mark_visited(landmark.id)
    assert stage.run(forget) is Status.SUCCESS
    assert landmark.id not in stage.mapper.semantic.visited
    assert stage.run(forget) is Status.FAILURE


def test_a_closed_room_has_nothing_left_to_explore(stage):
    frontier = stage.setup(GoToFrontier())
    assert stage.run(frontier) is Status.FAILURE
    assert frontier.feedback_message == "nothing left to explore"


def test_where_one_frontier_cannot_be_reached_the_next_is_tried(stage, monkeypatch):
    goals = iter([Pose2D(5.0, 0.0), Pose2D(1.5, 0.0), None])
    frontier = stage.setup(GoToFrontier())
    monkeypatch.setattr(frontier, "_choose", lambda pose: next(goals))
    assert stage.run(frontier) is Status.SUCCESS
    assert stage.robot.base_state.pose.x == pytest.approx(1.5, abs=0.35)
    assert stage.journal.counts["frontier"] == 2


def test_back_up_reverses_straight_and_says_how_far(stage):
    back = stage.setup(BackUp(distance=0.4))
    assert stage.run(back) is Status.SUCCESS
    assert stage.robot.base_state.pose.x == pytest.approx(-0.4, abs=0.05)
    assert stage.robot.base_state.pose.y == pytest.approx(0.0, abs=1e-6)
    assert back.moved == pytest.approx(0.4, abs=0.05)


def test_back_up_with_the_back_to_the_wall_does_not_move(stage):
    stage.robot.base_state = type(stage.robot.base_state)(Pose2D(-2.75, 0.0), stage.robot.twist, 0.0)
    back = stage.setup(BackUp(distance=0.5))
    assert stage.run(back) is Status.FAILURE
    assert back.feedback_message == "no room"
    assert stage.robot.base_state.pose.x == -2.75
