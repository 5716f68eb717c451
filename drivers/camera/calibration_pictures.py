"""Pictures that show people whether a calibration is good: corners found, straight lines, lines that meet."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivers.camera.calibration_file import Calibration, StereoCalibration
from drivers.camera.chessboard import Board
from zavis_bt.errors import InputError
from zavis_bt.types import FloatArray

Image = NDArray[np.uint8]
_LINES = 16
_GREEN = (60, 220, 60)


def draw_corners(images: Sequence[Image], corners: Sequence[NDArray[np.float32]], board: Board) -> Image:
    """Return the images beside each other with the corners that were found."""
    import cv2

    drawn = [image.copy() for image in images]
    for image, found in zip(drawn, corners, strict=True):
        cv2.drawChessboardCorners(image, (board.columns, board.rows), found.reshape(-1, 1, 2), True)
    return np.hstack(drawn)


def draw_undistorted(image: Image, calibration: Calibration) -> Image:
    """Return the image beside itself without the lens's distortion: straight things are straight on the right."""
    import cv2

    straight = cv2.undistort(image, calibration.matrix, calibration.distortion)
    return np.hstack((image, np.asarray(straight, dtype=np.uint8)))


def draw_rectified(left: Image, right: Image, calibration: StereoCalibration) -> Image:
    """Return the rectified images beside each other: each line meets the same thing in both."""
    import cv2

    c = calibration
    both = [_rectified(left, c.K1, c.D1, c.R1, c.P1), _rectified(right, c.K2, c.D2, c.R2, c.P2)]
    picture = np.hstack(both)
    for row in np.linspace(0, len(picture) - 1, _LINES + 2)[1:-1].astype(int).tolist():
        cv2.line(picture, (0, row), (picture.shape[1] - 1, row), _GREEN)
    return picture


def save_picture(path: Path, picture: Image) -> None:
    """Write a picture as PNG; makes its folder.

    Raises:
        InputError: It cannot be written.
    """
    import cv2

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(cv2.imencode(".png", picture)[1].tobytes())
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error


def _rectified(image: Image, matrix: FloatArray, distortion: FloatArray, turn: FloatArray, target: FloatArray) -> Image:
    import cv2

    size = image.shape[1], image.shape[0]
    first, second = cv2.initUndistortRectifyMap(matrix, distortion, turn, target, size, cv2.CV_16SC2)
    return np.asarray(cv2.remap(image, first, second, cv2.INTER_LINEAR), dtype=np.uint8)
