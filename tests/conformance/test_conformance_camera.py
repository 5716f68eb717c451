"""What every RGB-D camera must do."""

from __future__ import annotations

import math

import numpy as np
import pytest
from conformance_rigs import Rig, duration
from conformance_room import FACING_THE_WALL, WIDTH

from zavis_bt.geometry import back_project, transform_camera_to_map, transform_points
from zavis_bt.types import Box, RgbdFrame, Twist2D

START = FACING_THE_WALL


def latest(rig: Rig) -> RgbdFrame:
    """Return a frame that was taken after now."""
    begin = rig.clock.now()
    assert rig.wait_for(lambda: (frame := rig.robot.camera.frame()) is not None and frame.stamp > begin)
    frame = rig.robot.camera.frame()
    assert frame is not None
    return frame


def look(rig: Rig, pan: float, tilt: float) -> None:
    rig.robot.pan_tilt.move_to(pan, tilt)
    rig.run(0.05)
    assert rig.wait_for(rig.settled)
    rig.run(0.05)


@pytest.fixture(autouse=True)
def straight_ahead(rig: Rig) -> None:
    look(rig, 0.0, 0.0)


def test_images_have_the_shape_of_the_camera_model(rig: Rig) -> None:
    spec, frame = rig.robot.spec.camera, latest(rig)
    size = spec.intrinsics.height, spec.intrinsics.width
    assert frame.intrinsics.width, frame.intrinsics.height == size
    assert (frame.rgb.shape, frame.rgb.dtype) == ((*size, 3), np.uint8)
    assert (frame.depth.shape, frame.depth.dtype) == (size, np.float32)
    assert frame.transform_camera_to_map.shape == (4, 4)


def test_the_intrinsics_are_the_robots(rig: Rig) -> None:
    rig.only_simulated("a real camera tells its own")
    assert latest(rig).intrinsics == rig.robot.spec.camera.intrinsics


def test_depth_is_within_the_cameras_range_or_zero_for_no_reading(rig: Rig) -> None:
    spec = rig.robot.spec.camera
    for pan in (0.0, rig.sweep):
        look(rig, pan, 0.0)
        depth = latest(rig).depth
        read = depth[depth != 0]
        assert np.isfinite(depth).all()
        assert len(read) > 0
        assert read.min() >= spec.depth_min - 0.001
        assert read.max() <= spec.depth_max + 0.001


def test_what_is_farther_than_the_camera_measures_has_no_depth(rig: Rig) -> None:
    rig.only_simulated("needs to know how far it is")
    look(rig, 1.0, 0.0)
    assert (latest(rig).depth == 0).any()


def test_depth_is_measured_along_the_optical_axis(rig: Rig) -> None:
    truth, frame = rig.truth(), latest(rig)
    rows = slice(10, 30)  # wall, above the floor and below its top
    wall = (WIDTH - truth.x - rig.robot.spec.camera.x * math.cos(truth.yaw)) / math.cos(truth.yaw)
    assert frame.depth[rows, 20:44] == pytest.approx(wall, abs=0.03)


def test_points_lie_where_the_room_is(rig: Rig) -> None:
    """The map is the odometry's: what the camera sees lands on the wall and on the floor."""
    rig.truth()
    look(rig, 0.3, -0.4)
    frame = latest(rig)
    columns, rows = np.meshgrid(np.arange(64), np.arange(48))
    pixels = np.column_stack((columns.ravel() + 0.5, rows.ravel() + 0.5))
    depth = frame.depth.ravel().astype(np.float64)
    read = depth > 0
    optical = back_project(pixels[read], depth[read], frame.intrinsics)
    points = transform_points(frame.transform_camera_to_map, optical)
    on_wall, on_floor = np.abs(points[:, 0] - WIDTH) < 0.05, np.abs(points[:, 2]) < 0.05
    assert (on_wall | on_floor).mean() > 0.95
    assert on_wall.sum() > 50
    assert on_floor.sum() > 50


def test_the_pose_is_that_of_base_and_joints_at_the_stamp(rig: Rig) -> None:
    robot = rig.robot
    for pan, tilt in ((0.0, 0.0), (-rig.sweep, -0.3)):
        look(rig, pan, tilt)
        frame = latest(rig)
        base, joints = robot.base.pose_at(frame.stamp), robot.pan_tilt.angles_at(frame.stamp)
        pose = transform_camera_to_map(base, *joints, robot.spec.camera)
        np.testing.assert_allclose(frame.transform_camera_to_map, pose, atol=0.005)
        assert joints == pytest.approx((pan, tilt), abs=0.01)


def test_the_pose_is_that_at_the_stamp_while_everything_moves(rig: Rig) -> None:
    robot = rig.robot
    robot.pan_tilt.move_to(rig.sweep, 0.2)
    frames = []
    for _ in range(6):
        rig.drive(Twist2D(0.0, -rig.spin / 2), 0.1)
        frame = robot.camera.frame()
        assert frame is not None
        base, joints = robot.base.pose_at(frame.stamp), robot.pan_tilt.angles_at(frame.stamp)
        pose = transform_camera_to_map(base, *joints, robot.spec.camera)
        frames.append(float(np.abs(frame.transform_camera_to_map - pose).max()))
    assert np.median(frames) < 0.03
    rig.drive(Twist2D(0.0, rig.spin / 2), 0.6)


def test_what_is_seen_moves_with_the_joints(rig: Rig) -> None:
    one = latest(rig)
    look(rig, rig.sweep, 0.0)
    two = latest(rig)
    assert np.abs(one.transform_camera_to_map - two.transform_camera_to_map).max() > 0.1
    assert not np.array_equal(one.depth, two.depth)


def test_a_frame_is_the_same_object_until_the_next_and_stamps_increase(rig: Rig) -> None:
    seen: list[RgbdFrame] = []
    latest(rig)
    for _ in range(30):
        frame = rig.robot.camera.frame()
        assert frame is not None
        assert frame.stamp <= rig.clock.now()
        if not seen or frame is not seen[-1]:
            seen.append(frame)
        rig.run(0.02)
    stamps = [frame.stamp for frame in seen]
    assert len(set(stamps)) == len(stamps) > 2
    assert stamps == sorted(stamps)


def test_frames_are_fresh(rig: Rig) -> None:
    latest(rig)
    for _ in range(10):
        frame = rig.robot.camera.frame()
        assert frame is not None
        assert rig.clock.now() - frame.stamp < 1 / rig.robot.spec.camera.rate + rig.stale
        rig.run(0.05)


def test_a_frame_keeps_its_images_and_shares_no_memory_with_the_next(rig: Rig) -> None:
    frame = latest(rig)
    rgb, depth = frame.rgb, frame.depth
    copies = rgb.copy(), depth.copy()
    look(rig, rig.sweep, 0.1)
    other = latest(rig)
    assert frame.rgb is rgb
    assert frame.depth is depth
    assert not np.shares_memory(rgb, other.rgb)
    assert not np.shares_memory(depth, other.depth)
    np.testing.assert_array_equal(rgb, copies[0])
    np.testing.assert_array_equal(depth, copies[1])


def test_images_cannot_be_written_to(rig: Rig) -> None:
    frame = latest(rig)
    assert not frame.rgb.flags.writeable
    assert not frame.depth.flags.writeable


def test_single_depths_and_crops_are_those_of_the_images(rig: Rig) -> None:
    frame = latest(rig)
    pixels = np.array([[0, 0], [63, 47], [30, 20], [10, 40]])
    depths = frame.depth_at(pixels)
    crop = frame.crop(Box(10.0, 12.0, 30.0, 22.0))
    np.testing.assert_array_equal(depths, frame.depth[pixels[:, 1], pixels[:, 0]])
    np.testing.assert_array_equal(crop, frame.rgb[12:22, 10:30])


def test_nothing_blocks(rig: Rig) -> None:
    assert duration(rig.robot.camera.frame) < 0.002
