"""Calibrations of cameras as files, in OpenCV's own form of YAML (``cv2.FileStorage``).

Principal points in these files are OpenCV's: the middle of the first pixel is 0. `CameraIntrinsics` count from the
image's edge, where it is 0.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from zavis_bt.errors import InputError
from zavis_bt.types import CameraIntrinsics, FloatArray

Size = tuple[int, int]
_STEREO = ("K1", "D1", "K2", "D2", "R", "T", "R1", "R2", "P1", "P2", "Q")
_SHAPES = {"R": (3, 3), "R1": (3, 3), "R2": (3, 3), "P1": (3, 4), "P2": (3, 4), "Q": (4, 4)}


@dataclass(frozen=True, eq=False)
class Calibration:
    """One camera."""

    size: Size
    """Width and height of its images [px]."""
    matrix: FloatArray
    """(3, 3) camera matrix."""
    distortion: FloatArray
    """(n,) coefficients in OpenCV's order."""
    rms: float = 0.0
    """Reprojection error [px]."""
    depth_units: float = 1000.0
    """Depth images that belong to it count so many to the metre."""


@dataclass(frozen=True, eq=False)
class StereoCalibration:
    """A left and a right camera, and how to bring their images into line. Names as in OpenCV's ``stereoRectify``."""

    size: Size
    """Width and height of each image [px]."""
    K1: FloatArray
    D1: FloatArray
    K2: FloatArray
    D2: FloatArray
    R: FloatArray
    """(3, 3) left to right."""
    T: FloatArray
    """(3,) left to right [m]."""
    R1: FloatArray
    R2: FloatArray
    P1: FloatArray
    P2: FloatArray
    Q: FloatArray
    rms: float = 0.0
    """Reprojection error [px]."""

    @property
    def baseline(self) -> float:
        """How far the right camera is to the right of the left one [m]."""
        return float(-self.P2[0, 3] / self.P2[0, 0])


def intrinsics_of(matrix: FloatArray, size: Size, target: Size) -> CameraIntrinsics:
    """Return the pinhole model of OpenCV's matrix (3, 3 or more) for images of ``size`` resized to ``target``."""
    across, down = target[0] / size[0], target[1] / size[1]
    fx, fy, cx, cy = (float(matrix[place]) for place in ((0, 0), (1, 1), (0, 2), (1, 2)))
    return CameraIntrinsics(*target, fx * across, fy * down, (cx + 0.5) * across, (cy + 0.5) * down)


def matrix_of(intrinsics: CameraIntrinsics) -> FloatArray:
    """Return OpenCV's matrix (3, 3) of a pinhole model."""
    i = intrinsics
    return np.array([[i.fx, 0.0, i.cx - 0.5], [0.0, i.fy, i.cy - 0.5], [0.0, 0.0, 1.0]])


def read_calibration(path: Path) -> Calibration:
    """Read one camera's calibration.

    Raises:
        InputError: The file is missing, damaged or of another kind.
    """
    file = _File(path)
    size, units = file.size(), file.number("depth_units", 1000.0)
    matrix, distortion = file.matrix("camera_matrix", (3, 3)), file.optional_vector("distortion_coefficients")
    return Calibration(size, matrix, distortion, file.number("rms", 0.0, least=0.0), units)


def read_stereo(path: Path) -> StereoCalibration:
    """Read a stereo pair's calibration.

    Raises:
        InputError: The file is missing, damaged or of another kind.
    """
    file = _File(path)
    size, rms = file.size(), file.number("rms", 0.0, least=0.0)
    values = {name: file.matrix(name, _SHAPES.get(name)) for name in _STEREO}
    values.update({name: values[name].ravel() for name in ("D1", "D2", "T")})
    calibration = StereoCalibration(size, **values, rms=rms)
    if not calibration.baseline > 0:
        raise InputError(f"{path}: P2: the right camera is not to the right of the left one (swap them)")
    return calibration


def write_calibration(path: Path, calibration: Calibration) -> None:
    """Write one camera's calibration.

    Raises:
        InputError: The file cannot be written.
    """
    values = {"camera_matrix": calibration.matrix, "distortion_coefficients": calibration.distortion.reshape(1, -1)}
    _write(path, calibration.size, {**values, "rms": calibration.rms, "depth_units": calibration.depth_units})


def write_stereo(path: Path, calibration: StereoCalibration) -> None:
    """Write a stereo pair's calibration.

    Raises:
        InputError: The file cannot be written.
    """
    values = {name: getattr(calibration, name) for name in _STEREO}
    values.update({name: values[name].reshape(1, -1) for name in ("D1", "D2")}, T=calibration.T.reshape(3, 1))
    _write(path, calibration.size, {**values, "rms": calibration.rms})


def _write(path: Path, size: Size, values: dict[str, Any]) -> None:
    import cv2

    storage = cv2.FileStorage(".yaml", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    for name, value in ({"image_width": size[0], "image_height": size[1]} | values).items():
        storage.write(name, value)
    try:
        path.write_text(storage.releaseAndGetString(), encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error


class _File:
    """A file that is being read."""

    def __init__(self, path: Path) -> None:
        import cv2

        self._path, self._cv2_error = path, cv2.error
        try:
            text = path.read_text(encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror} (zavis camera calibrate makes one)") from error
        except UnicodeDecodeError as error:
            raise InputError(f"{path}: is not UTF-8 text") from error
        try:
            self._storage = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
        except (cv2.error, SystemError) as error:  # SystemError: how its binding reports what it cannot parse
            raise InputError(f"{path}: is not YAML as OpenCV writes it (zavis camera calibrate does)") from error

    def size(self) -> Size:
        width, height = self.number("image_width"), self.number("image_height")
        return int(width), int(height)

    def number(self, name: str, default: float | None = None, least: float = 1e-3) -> float:
        node = self._storage.getNode(name)
        if node.empty() and default is not None:
            return default
        value = node.real() if node.isInt() or node.isReal() else -1.0
        if not least <= value < np.inf:
            raise InputError(f"{self._path}: {name}: is missing or no positive number")
        return float(value)

    def optional_vector(self, name: str) -> FloatArray:
        return np.zeros(5) if self._storage.getNode(name).empty() else self.matrix(name).ravel()

    def matrix(self, name: str, shape: Sequence[int] | None = None) -> FloatArray:
        try:
            value = self._storage.getNode(name).mat()
        except self._cv2_error:
            value = None
        if value is None:
            raise InputError(f"{self._path}: {name}: is missing or no matrix (zavis camera calibrate writes it)")
        if shape is not None and value.shape != tuple(shape):
            raise InputError(f"{self._path}: {name}: has shape {value.shape} (should be {tuple(shape)})")
        if not np.isfinite(value).all():
            raise InputError(f"{self._path}: {name}: is not finite")
        return np.asarray(value, dtype=np.float64)
