from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from camera_boards import COLUMNS, ROWS, SIZE, SQUARE, BoardCamera, poses

from drivers.camera.calibrate import Views, calibrate_camera, calibrate_pair
from drivers.camera.calibration_file import (
    Calibration,
    intrinsics_of,
    matrix_of,
    read_calibration,
    read_stereo,
    write_calibration,
    write_stereo,
)
from drivers.camera.chessboard import Board, find_corners, parse_board
from zavis_bt.errors import InputError
from zavis_bt.types import CameraIntrinsics

BOARD = Board(COLUMNS, ROWS, SQUARE)
BASELINE = 0.06


@pytest.fixture(scope="module")
def cameras():
    right = BoardCamera(
        np.array([[530.0, 0.0, 318.0], [0.0, 528.0, 244.0], [0.0, 0.0, 1.0]]),
        np.array([-0.2, 0.05, 0.0, 0.001, 0.0]),
        BASELINE,
    )
    return BoardCamera(), right


@pytest.fixture(scope="module")
def seen(cameras):
    """Images of both cameras of nine boards."""
    return [
        [camera.see(*pose, noise=2 * number + side) for side, camera in enumerate(cameras)]
        for number, pose in enumerate(poses(9))
    ]


@pytest.fixture(scope="module")
def views(seen):
    found = Views(BOARD, 2)
    assert [found.add(f"{number}.png", images) for number, images in enumerate(seen)] == [""] * len(seen)
    return found


def copy(views: Views) -> Views:
    again = Views(views.board, views.cameras)
    again.size, again.accepted = views.size, list(views.accepted)
    return again


def displacement(calibration: Calibration, camera: BoardCamera) -> float:
    """Return by how much the two models disagree on where things are seen, at worst [px]."""
    grid = np.stack(np.meshgrid(np.linspace(-0.4, 0.4, 9), np.linspace(-0.3, 0.3, 7)), axis=-1).reshape(-1, 2)
    points = np.column_stack((grid, np.ones(len(grid))))
    none = np.zeros(3)
    one, _ = cv2.projectPoints(points, none, none, calibration.matrix, calibration.distortion)
    two, _ = cv2.projectPoints(points, none, none, camera.matrix, camera.distortion)
    return float(np.linalg.norm(one - two, axis=2).max())


def test_the_cameras_are_recovered(views, cameras):
    for side, camera in enumerate(cameras):
        calibration, dropped = calibrate_camera(copy(views), side)
        assert not dropped
        assert calibration.rms < 0.3
        np.testing.assert_allclose(calibration.matrix, camera.matrix, atol=5.0)
        np.testing.assert_allclose(calibration.distortion[:2], camera.distortion[:2], atol=0.05)
        assert displacement(calibration, camera) < 4.0


def test_the_pair_is_recovered(views):
    calibration, dropped = calibrate_pair(copy(views))
    assert not dropped
    assert calibration.rms < 0.3
    assert calibration.baseline == pytest.approx(BASELINE, abs=0.001)
    np.testing.assert_allclose(calibration.T, [-BASELINE, 0.0, 0.0], atol=0.001)
    np.testing.assert_allclose(calibration.R, np.eye(3), atol=0.01)
    assert calibration.P1[0, 2] == calibration.P2[0, 2]


def test_rectified_corners_lie_in_the_same_rows(views):
    c, _ = calibrate_pair(copy(views))
    for view in views.accepted:
        left = cv2.undistortPoints(view.corners[0][:, None], c.K1, c.D1, R=c.R1, P=c.P1)
        right = cv2.undistortPoints(view.corners[1][:, None], c.K2, c.D2, R=c.R2, P=c.P2)
        assert np.abs(left[..., 1] - right[..., 1]).mean() < 0.3
        assert (left[..., 0] > right[..., 0]).all()


def test_exchanged_cameras_are_named(views):
    swapped = copy(views)
    swapped.accepted = [replace(view, corners=view.corners[::-1]) for view in swapped.accepted]
    with pytest.raises(InputError, match="swap them"):
        calibrate_pair(swapped)


def test_a_view_that_fits_far_worse_is_left_out(views, cameras):
    bent = copy(views)
    wrong = bent.accepted[3]
    shake = np.random.default_rng(2).normal(0.0, 6.0, wrong.corners[0].shape).astype(np.float32)
    bent.accepted[3] = replace(wrong, corners=(wrong.corners[0] + shake, wrong.corners[1]))
    calibration, dropped = calibrate_camera(bent)
    assert list(dropped) == ["3.png"]
    assert calibration.rms < 0.3
    assert displacement(calibration, cameras[0]) < 5.0


def test_too_few_views_do_not_do(views):
    few = copy(views)
    few.accepted = few.accepted[:4]
    with pytest.raises(InputError, match=r"4 views are of use .at least 6"):
        calibrate_camera(few)


def test_useless_views_are_refused_with_the_reason(seen):
    image = seen[0][0]
    views = Views(BOARD, 1)
    assert views.add("a.png", [image]) == ""
    assert "much the same as a.png" in views.add("b.png", [image])
    assert "the others have 640 x 480" in views.add("c.png", [image[:400]])
    assert "no board of 9 x 6" in views.add("d.png", [np.full_like(image, 128)])
    assert "no board of 9 x 6" in views.add("e.png", [image[:, :300].copy().repeat(3, axis=1)[:, :640]])
    assert len(views.accepted) == 1
    assert 0.0 < views.coverage < 0.5


def test_a_blurred_board_and_a_far_one_are_refused(cameras):
    turn, shift = poses(1)[0]
    blurred = cv2.GaussianBlur(cameras[0].see(turn, shift), (0, 0), 5.0)
    assert "blurred" in find_corners(blurred, BOARD)[1]
    far = cameras[0].see(np.zeros(3), np.array([-0.12, -0.07, 2.2]))
    assert "too small" in find_corners(far, BOARD)[1]


def test_a_pair_needs_the_board_in_both_images(seen):
    views = Views(BOARD, 2)
    assert views.add("a.png", [seen[0][0], np.zeros_like(seen[0][0])]).startswith("right: no board")
    assert views.add("b.png", [seen[0][0], np.rot90(seen[0][1], 2).copy()]) == ""
    left, right = views.accepted[0].corners
    assert np.dot(left[-1] - left[0], right[-1] - right[0]) > 0


@pytest.mark.parametrize("text", ["9", "9x", "ninexsix", "9x9", "2x3", "9x6x1", "-9x6"])
def test_a_board_that_is_none_is_refused(text):
    with pytest.raises(InputError, match="--board"):
        parse_board(text, 0.03)


def test_a_board_may_be_written_either_way():
    assert parse_board("6X9", 0.03) == parse_board("9 x 6", 0.03) == Board(9, 6, 0.03)


def test_files_keep_calibrations(views, tmp_path):
    one, _ = calibrate_camera(copy(views))
    pair, _ = calibrate_pair(copy(views))
    write_calibration(tmp_path / "one.yaml", one)
    write_stereo(tmp_path / "pair.yaml", pair)
    again, pair_again = read_calibration(tmp_path / "one.yaml"), read_stereo(tmp_path / "pair.yaml")
    assert again.size == pair_again.size == SIZE
    np.testing.assert_array_equal(again.matrix, one.matrix)
    np.testing.assert_array_equal(again.distortion, one.distortion)
    for name in ("K1", "D1", "K2", "D2", "R", "T", "R1", "R2", "P1", "P2", "Q"):
        np.testing.assert_array_equal(getattr(pair_again, name), getattr(pair, name))
    storage = cv2.FileStorage(str(tmp_path / "pair.yaml"), cv2.FILE_STORAGE_READ)
    assert storage.getNode("image_width").real() == 640
    np.testing.assert_array_equal(storage.getNode("Q").mat(), pair.Q)
    storage.release()


def test_a_pairs_file_with_a_fault_is_refused(views, tmp_path):
    pair, _ = calibrate_pair(copy(views))
    path = tmp_path / "pair.yaml"
    write_stereo(path, replace(pair, P2=pair.P1))
    with pytest.raises(InputError, match="swap them"):
        read_stereo(path)
    write_stereo(path, replace(pair, Q=np.eye(3)))
    with pytest.raises(InputError, match=r"Q: has shape \(3, 3\)"):
        read_stereo(path)
    path.write_text(path.read_text().replace("R1:", "R9:"))
    with pytest.raises(InputError, match="R1: is missing"):
        read_stereo(path)
    with pytest.raises(InputError, match="cannot be written"):
        write_stereo(tmp_path / "no" / "pair.yaml", pair)


def test_pixels_are_counted_from_the_edge_here_and_from_the_first_middle_there():
    """A pinhole in the middle of the image stays there whatever the image's size."""
    middle = CameraIntrinsics(640, 480, 500.0, 510.0, 320.0, 240.0)
    assert matrix_of(middle)[0, 2] == 319.5
    assert intrinsics_of(matrix_of(middle), (640, 480), (640, 480)) == middle
    assert intrinsics_of(matrix_of(middle), (640, 480), (320, 120)) == CameraIntrinsics(320, 120, 250, 127.5, 160, 60)
