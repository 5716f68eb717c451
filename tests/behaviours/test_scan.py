from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scripted import SPEC, ScriptedRobot, Stage

from behaviours import Scan
from zavis_bt.tree import Status


def headings(stage: Stage) -> np.ndarray:
    axes = np.array([frame.transform_camera_to_map[:2, 2] for frame in stage.perceiver.frames])
    return np.arctan2(axes[:, 1], axes[:, 0])


def largest_gap(angles: np.ndarray) -> float:
    ordered = np.sort(angles % math.tau)
    return float(np.diff(np.append(ordered, ordered[0] + math.tau)).max())


@pytest.mark.parametrize("lidar_fov", [math.tau, math.pi], ids=["LiDAR all round", "LiDAR half round"])
def test_neighbouring_frames_overlap_all_around(lidar_fov):
    spec = replace(SPEC, lidar=replace(SPEC.lidar, field_of_view=lidar_fov, beams=181))
    stage = Stage(robot=ScriptedRobot(spec))
    scan = stage.setup(Scan(target="cup"))
    assert stage.run(scan) is Status.SUCCESS
    assert largest_gap(headings(stage)) <= spec.camera.intrinsics.horizontal_fov


def test_a_half_round_lidar_makes_the_base_turn_and_a_full_one_does_not():
    for fov, turned in ((math.tau, False), (math.pi, True)):
        spec = replace(SPEC, lidar=replace(SPEC.lidar, field_of_view=fov, beams=181))
        stage = Stage(robot=ScriptedRobot(spec))
        stage.run(stage.setup(Scan(target="cup")))
        assert (abs(stage.robot.base_state.pose.yaw) > 1.0) is turned


def test_each_tilt_is_a_pass_of_its_own(stage):
    stage.run(stage.setup(Scan(target="cup", tilts=[-0.4, 0.1])))
    tilts = [tilt for _, tilt in stage.robot.moves]
    assert tilts.count(-0.4) == tilts.count(0.1) == len(tilts) // 2


def test_landmarks_and_candidates_come_from_the_same_frames(stage):
    stage.perceiver.landmarks = {(2.0, 0.0): "desk", (0.0, -2.0): "bed"}
    stage.perceiver.targets = [(2.0, 0.1, 0.8)]
    scan = stage.setup(Scan(target="cup"))
    assert stage.run(scan) is Status.SUCCESS
    assert {landmark.label for landmark in stage.mapper.semantic.landmarks} == {"desk", "bed"}
    assert scan.landmarks == 2
    assert scan.candidates[0].position == (2.0, 0.1, 0.8)
    assert stage.journal.counts["scan"] == 1


def test_pictures_are_taken_at_rest_only(stage):
    stage.run(stage.setup(Scan(target="cup")))
    settled = {round(2 * 0.1, 3)}
    stamps = np.array([frame.stamp for frame in stage.perceiver.frames])
    assert np.all(np.diff(stamps) >= min(settled) - 1e-9)


def test_stopping_half_way_stops_camera_and_base(stage):
    scan = stage.setup(Scan(target="cup"))
    for _ in range(4):
        stage.tick(scan)
    scan.stop(Status.INVALID)
    assert stage.robot.pan_tilt.stops == 1
    assert stage.robot.twist.angular == 0.0
