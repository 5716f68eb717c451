"""Recorded RGB-D frames as a folder, laid out as the TUM RGB-D benchmark's are.

``rgb.txt`` and ``depth.txt`` list one image a line, ``<stamp [s]> <file>``; lines that begin with # are comments.
Depth images have 16 bits. ``camera.yaml`` has the camera matrix in OpenCV's form and ``depth_units``, the depth
images' counts to the metre: 1000 as written here, 5000 in the benchmark's own sequences.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivers.camera.calibration_file import intrinsics_of, read_calibration
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.types import CameraIntrinsics

CAMERA = "camera.yaml"
_APART = 0.02  # an image and its depth image are so far apart, at most [s]
Entries = list[tuple[float, Path]]


@dataclass(frozen=True, slots=True)
class RecordedFrame:
    """One frame of a recording."""

    stamp: float
    """On the recording's own clock [s]."""
    rgb: Path
    depth: Path
    intrinsics: CameraIntrinsics
    depth_units: float

    def pixels(self) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Return colour (h, w, 3) uint8 and depth (h, w) float32 [m].

        Raises:
            DeviceError: An image is missing, damaged or of the wrong kind.
        """
        size = self.intrinsics.height, self.intrinsics.width
        rgb, counts = _read_image(self.rgb, (*size, 3)), _read_image(self.depth, size)
        return rgb.astype(np.uint8, copy=False), (counts / np.float32(self.depth_units)).astype(np.float32)


def read_recording(folder: Path) -> tuple[RecordedFrame, ...]:
    """Return the frames of a recording in order.

    Raises:
        InputError: It is not such a folder, or something in it is wrong.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder (of a recorded camera)")
    calibration = read_calibration(folder / CAMERA)
    if np.any(calibration.distortion):
        raise InputError(f"{folder / CAMERA}: distorted images cannot be played back (undistort them)")
    intrinsics = intrinsics_of(calibration.matrix, calibration.size, calibration.size)
    depths = _read_index(folder / "depth.txt")
    frames = tuple(
        RecordedFrame(stamp, rgb, depth, intrinsics, calibration.depth_units)
        for stamp, rgb in _read_index(folder / "rgb.txt")
        if (depth := _nearest(depths, stamp)) is not None
    )
    if not frames:
        raise InputError(f"{folder}: no line of rgb.txt has one of depth.txt within {_APART:g} s")
    return frames


def _read_index(path: Path) -> Entries:
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({getattr(error, 'strerror', None) or 'is not UTF-8'})") from error
    entries = []
    for number, line in enumerate(lines, 1):
        stamp, _, name = line.strip().partition(" ")
        if not stamp or stamp.startswith("#"):
            continue
        try:
            entries.append((float(stamp), path.parent / name.strip()))
        except ValueError:
            raise InputError(f"{path}:{number}: '{line.strip()}' is not '<stamp> <file>'") from None
        if not name.strip() or not np.isfinite(entries[-1][0]):
            raise InputError(f"{path}:{number}: '{line.strip()}' is not '<stamp> <file>'")
    return sorted(entries)


def _nearest(entries: Entries, stamp: float) -> Path | None:
    place = bisect_left(entries, stamp, key=lambda entry: entry[0])
    near = min(entries[max(place - 1, 0) : place + 1], key=lambda entry: abs(entry[0] - stamp), default=None)
    return near[1] if near is not None and abs(near[0] - stamp) <= _APART else None


def _read_image(path: Path, shape: tuple[int, ...]) -> NDArray[Any]:
    import cv2

    dtype = np.uint8 if len(shape) == 3 else np.uint16
    try:
        data = np.frombuffer(path.read_bytes(), np.uint8)
    except OSError as error:
        raise DeviceError(f"{path}: cannot be read: {error.strerror}") from error
    flag = cv2.IMREAD_COLOR if len(shape) == 3 else cv2.IMREAD_UNCHANGED
    image = cv2.imdecode(data, flag) if data.size else None
    if image is None:
        raise DeviceError(f"{path}: is not an image, or is damaged")
    if image.shape != shape or image.dtype != dtype:
        found = " x ".join(map(str, image.shape))
        raise DeviceError(f"{path}: {found} {image.dtype} (should be {' x '.join(map(str, shape))} {dtype.__name__})")
    return cv2.cvtColor(image, cv2.COLOR_BGR2RGB) if len(shape) == 3 else image
