"""Calibrating a camera, or a stereo pair, from views of a chessboard (Zhang's method, by OpenCV)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivers.camera.calibration_file import Calibration, Size, StereoCalibration
from drivers.camera.chessboard import Board, Corners, find_corners, same_order
from zavis_bt.errors import InputError
from zavis_bt.types import FloatArray

LEAST_VIEWS = 6
"""Fewer do not determine a camera."""
_ALIKE = 0.01  # views whose corners differ by less, as a share of the image's width, tell nothing new
_OUTLIER, _HARMLESS = 3.0, 0.5  # times the median error above which a view is left out, unless below so many [px]


@dataclass(frozen=True, slots=True)
class View:
    """A board as all cameras saw it at once."""

    name: str
    corners: tuple[Corners, ...]
    """(n, 2) for each camera [px]."""


class Views:
    """Collects the views that are of use."""

    def __init__(self, board: Board, cameras: int) -> None:
        self.board, self.cameras = board, cameras
        self.accepted: list[View] = []
        self.size: Size | None = None
        """Width and height of the images [px], as the first one has them."""

    def add(self, name: str, images: Sequence[NDArray[np.uint8]]) -> str:
        """Take the images of one moment, one for each camera; return why they are of no use, or nothing."""
        size = images[0].shape[1], images[0].shape[0]
        self.size = self.size or size
        for image in images:
            if image.shape[1::-1] != self.size:
                return f"{image.shape[1]} x {image.shape[0]} pixels (the others have {self.size[0]} x {self.size[1]})"
        found = [find_corners(image, self.board) for image in images]
        for side, (_, reason) in zip(("left: ", "right: ") if len(found) > 1 else ("",), found, strict=True):
            if reason:
                return side + reason
        corners = [corners for corners, _ in found if corners is not None]
        view = View(name, tuple(same_order(corners[0], other) for other in corners))
        for other in self.accepted:
            if _difference(view, other) < _ALIKE * self.size[0]:
                return f"much the same as {other.name} (move the board)"
        self.accepted.append(view)
        return ""

    @property
    def coverage(self) -> float:
        """Share of the image that the boards have been in, 0 to 1; of the camera that saw least of them."""
        if self.size is None or not self.accepted:
            return 0.0
        return min(
            _coverage([view.corners[camera] for view in self.accepted], self.size) for camera in range(self.cameras)
        )

    def drop(self, names: Sequence[str]) -> None:
        """Forget views."""
        self.accepted = [view for view in self.accepted if view.name not in names]


def calibrate_camera(views: Views, camera: int = 0) -> tuple[Calibration, dict[str, float]]:
    """Calibrate one camera.

    Args:
        views: What it has seen; views that fit far worse than the others are dropped from it.
        camera: Which of those in the views.

    Returns:
        The calibration, and the reprojection errors of the views that were dropped, by name [px].

    Raises:
        InputError: There are too few views, or they do not determine a camera.
    """
    calibration, errors = _solve(views, camera)
    limit = max(_OUTLIER * float(np.median(errors)), _HARMLESS)
    outliers = {view.name: error for view, error in zip(views.accepted, errors, strict=True) if error > limit}
    if not outliers:
        return calibration, {}
    views.drop(list(outliers))
    return _solve(views, camera)[0], outliers


def calibrate_pair(views: Views) -> tuple[StereoCalibration, dict[str, float]]:
    """Calibrate a stereo pair: each camera by itself, then where they are to each other, then the rectification.

    Returns:
        The calibration, and the reprojection errors of the views that were dropped, by name [px].

    Raises:
        InputError: There are too few views, or they do not determine the cameras.
    """
    left, dropped = calibrate_camera(views, 0)
    right, more = calibrate_camera(views, 1)
    if more:
        left, _ = _solve(views, 0)
    turn, shift, rms = _solve_pair(views, left, right)
    if shift[0] >= 0 or abs(shift[0]) < abs(shift[1]):
        raise InputError("calibrate: the right camera is not to the right of the left one (swap them)")
    return _rectified(left, right, turn, shift, rms), dropped | more


def _solve_pair(views: Views, left: Calibration, right: Calibration) -> tuple[FloatArray, FloatArray, float]:
    """Return rotation (3, 3) and translation (3,) [m] from left to right, and the reprojection error [px]."""
    opencv = _opencv()
    points = [views.board.points] * len(views.accepted)
    seen = [[view.corners[camera] for view in views.accepted] for camera in (0, 1)]
    models = [array.copy() for one in (left, right) for array in (one.matrix, one.distortion)]
    solved = opencv.stereoCalibrate(points, *seen, *models, left.size, flags=opencv.CALIB_FIX_INTRINSIC)
    rms, _, _, _, _, turn, shift = solved[:7]
    return turn, np.ravel(shift), float(rms)


def _rectified(
    left: Calibration, right: Calibration, turn: FloatArray, shift: FloatArray, rms: float
) -> StereoCalibration:
    opencv = _opencv()
    models = left.matrix, left.distortion, right.matrix, right.distortion
    R1, R2, P1, P2, Q, *_ = opencv.stereoRectify(
        *models, left.size, turn, shift.reshape(3, 1), flags=opencv.CALIB_ZERO_DISPARITY, alpha=0
    )
    return StereoCalibration(left.size, *models, turn, shift, R1, R2, P1, P2, Q, rms)


def _solve(views: Views, camera: int) -> tuple[Calibration, FloatArray]:
    """Return the calibration, and the reprojection error of each view [px]."""
    opencv = _opencv()
    if len(views.accepted) < LEAST_VIEWS:
        raise InputError(f"calibrate: {len(views.accepted)} views are of use (at least {LEAST_VIEWS}, better 20)")
    assert views.size is not None
    points = [views.board.points] * len(views.accepted)
    corners = [view.corners[camera] for view in views.accepted]
    try:
        rms, matrix, distortion, _, _, _, _, errors = opencv.calibrateCameraExtended(
            points, corners, views.size, np.eye(3), np.zeros(5), flags=opencv.CALIB_FIX_K3
        )
    except opencv.error as error:
        raise InputError("calibrate: the views do not determine the camera (tilt the board more)") from error
    if not np.isfinite(matrix).all():
        raise InputError("calibrate: the views do not determine the camera (tilt the board more)")
    return Calibration(views.size, matrix, np.ravel(distortion), float(rms)), np.ravel(errors)


def _difference(view: View, other: View) -> float:
    """Return how far the corners have moved on average, in the camera where they moved most [px]."""
    moves = (np.linalg.norm(a - b, axis=1).mean() for a, b in zip(view.corners, other.corners, strict=True))
    return float(max(moves))


def _coverage(corners: Sequence[Corners], size: Size) -> float:
    """Return the share of an image of ``size`` in 8 × 6 fields that hold a corner."""
    places = np.concatenate(corners) / size * (8, 6)
    columns, rows = np.clip(places.astype(int), 0, (7, 5)).T
    return len(set(zip(columns.tolist(), rows.tolist(), strict=True))) / 48


def _opencv() -> Any:
    """Return OpenCV, whose stubs know neither of the arrays it takes here nor of those it returns."""
    import cv2

    return cv2
