from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from camera_rigs import BASELINE, DEPTHS, camera_spec, context, stereo_calibration, stereo_views, textured, wait_for

from drivers.camera import open_stereo
from drivers.camera.calibration_file import write_stereo
from drivers.camera.stereo_depth import StereoDepth
from zavis_bt.errors import DeviceError, InputError

SPEC = camera_spec(320, 240)
SIZE = (320, 240)


@pytest.fixture(scope="module")
def views():
    left, right = stereo_views(SPEC)
    return left, textured(left), textured(right)


@pytest.fixture(scope="module")
def folder(views, tmp_path_factory):
    """Images and videos of both eyes, and the calibration."""
    folder = tmp_path_factory.mktemp("pair")
    write_stereo(folder / "pair.yaml", stereo_calibration(SPEC))
    for number in range(3):
        for name, image in (("left", views[1]), ("right", views[2]), ("both", np.hstack(views[1:]))):
            cv2.imwrite(str(folder / f"{name}_{number:03d}.png"), image)
    return folder


def relative_error(depth: np.ndarray, true: np.ndarray) -> np.ndarray:
    read = (depth > 0) & (true > 0)
    return np.abs(depth[read] - true[read]) / true[read]


def check(depth: np.ndarray, true: np.ndarray) -> None:
    """Depth is there almost everywhere and right to a fraction of a pixel's disparity."""
    assert ((depth > 0) & (true > 0)).mean() > 0.9
    error = relative_error(depth, true)
    assert np.median(error) < 0.03
    assert np.percentile(error, 90) < 0.1


def test_depth_is_that_of_the_simulated_room(views):
    frame, left, right = views
    rgb, depth = StereoDepth(stereo_calibration(SPEC), SIZE, *DEPTHS)(left, right)
    check(depth, frame.depth)
    assert depth.dtype == np.float32
    np.testing.assert_array_equal(rgb, left[:, :, ::-1])


def test_depth_is_measured_up_to_the_left_edge(views):
    _, left, right = views
    _, depth = StereoDepth(stereo_calibration(SPEC), SIZE, *DEPTHS)(left, right)
    assert (depth[:, :64] > 0).mean() > 0.8


def test_depth_beyond_the_cameras_range_is_no_reading(views):
    _, left, right = views
    _, depth = StereoDepth(stereo_calibration(SPEC), SIZE, 1.0, 3.0)(left, right)
    read = depth[depth > 0]
    assert read.min() >= 1.0
    assert read.max() <= 3.0


def test_another_image_size_rescales_the_camera_model(views):
    frame, left, right = views
    stereo = StereoDepth(stereo_calibration(SPEC), (160, 120), *DEPTHS)
    rgb, depth = stereo(left, right)
    assert rgb.shape == (120, 160, 3)
    assert stereo.intrinsics == camera_spec(160, 120).intrinsics
    assert np.median(relative_error(depth, frame.depth[1::2, 1::2])) < 0.06


def test_principal_points_may_differ(views):
    """Without zero disparity at infinity: the right image is shifted, and its projection says so."""
    frame, left, right = views
    calibration = stereo_calibration(SPEC)
    projection, matrix = calibration.P2.copy(), calibration.K2.copy()
    projection[0, 2] = matrix[0, 2] = projection[0, 2] - 6.0
    moved = replace(calibration, P2=projection, K2=matrix)
    _, depth = StereoDepth(moved, SIZE, *DEPTHS)(left, np.roll(right, -6, axis=1))
    check(depth[:, :300], frame.depth[:, :300])


def test_a_turned_right_camera_is_rectified(views):
    frame, left, right = views
    calibration = stereo_calibration(SPEC)
    turn, _ = cv2.Rodrigues(np.array([0.02, -0.01, 0.015]))
    homography = calibration.K2 @ turn @ np.linalg.inv(calibration.K2)
    crooked = cv2.warpPerspective(right, homography, SIZE)
    turned = replace(calibration, R2=turn.T)
    _, depth = StereoDepth(turned, SIZE, *DEPTHS)(left, crooked)
    assert np.median(relative_error(depth, frame.depth)) < 0.03


def test_flat_grey_images_have_no_depth():
    grey = np.full((240, 320, 3), 128, np.uint8)
    _, depth = StereoDepth(stereo_calibration(SPEC), SIZE, *DEPTHS)(grey, grey)
    assert (depth == 0).mean() > 0.95


@pytest.mark.parametrize("names", [("left", "right"), ("both",)], ids=["two videos", "side by side"])
def test_videos_of_both_eyes_become_frames(folder, views, names):
    sources = {eye: str(folder / f"{name}_%03d.png") for eye, name in zip(("left", "right"), names, strict=False)}
    camera = open_stereo({**sources, "calibration": str(folder / "pair.yaml")}, context(SPEC))
    try:
        assert wait_for(camera.frame)
        frame, report = camera.frame(), camera.report()
    finally:
        camera.close()
    assert frame.intrinsics.fx == pytest.approx(SPEC.intrinsics.fx)
    assert (frame.intrinsics.cx, frame.intrinsics.cy) == pytest.approx((160.0, 120.0))
    assert frame.transform_camera_to_map[0, 3] == frame.stamp
    check(frame.depth, views[0].depth)
    assert report.figures["baseline"] == f"{1000 * BASELINE:.1f} mm"
    assert not report.problems or "has ended" in report.problems[0]


def test_a_video_that_ends_begins_again(folder):
    video = str(folder / "both_%03d.png")
    camera = open_stereo({"left": video, "calibration": str(folder / "pair.yaml")}, context(camera_spec(320, 240, 50)))
    assert wait_for(lambda: camera.report().figures["lost"] != "0 times" and not camera.report().problems)
    camera.close()


def test_a_compressed_video_file_is_read(folder, views):
    path = folder / "both.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 10.0, (640, 240))
    for _ in range(5):
        writer.write(np.hstack(views[1:]))
    writer.release()
    camera = open_stereo({"left": str(path), "calibration": str(folder / "pair.yaml")}, context(SPEC))
    assert wait_for(camera.frame)
    frame = camera.frame()
    camera.close()
    assert np.median(relative_error(frame.depth, views[0].depth)) < 0.04


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"left": 0}, InputError, "calibration: is missing"),
        ({"left": 0, "calibration": "nowhere.yaml"}, InputError, "nowhere.yaml: cannot be read"),
        ({"left": "nowhere.avi", "calibration": "PAIR"}, DeviceError, "there is no nowhere.avi"),
        ({"left": 63, "calibration": "PAIR"}, DeviceError, "there is no /dev/video63 .*plug the camera in"),
        ({"left": "PAIR", "calibration": "PAIR"}, DeviceError, "cannot open it"),
        ({"left": 0, "calibration": "PAIR", "block_size": 4}, InputError, "should be odd"),
        ({"left": 0, "calibration": "PAIR", "blocksize": 4}, InputError, "unknown setting .did you mean 'block_size'"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(folder, settings, error, words, capfd):
    filled = {name: str(folder / "pair.yaml") if value == "PAIR" else value for name, value in settings.items()}
    with pytest.raises(error, match=words) as caught:
        open_stereo(filled, context(SPEC))
    assert "\n" not in str(caught.value)
    assert capfd.readouterr().err == ""


def test_images_of_another_size_than_calibrated_are_a_fault(folder, views, tmp_path):
    cv2.imwrite(str(tmp_path / "small_000.png"), np.hstack(views[1:])[::2, ::2])
    sources = {"left": str(tmp_path / "small_%03d.png"), "calibration": str(folder / "pair.yaml")}
    camera = open_stereo(sources, context(SPEC))
    assert wait_for(lambda: any("calibrated at 320 x 240" in problem for problem in camera.report().problems))
    camera.close()
