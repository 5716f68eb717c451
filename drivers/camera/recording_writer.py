"""Recording a camera's frames to a folder that `drivers.camera.recording` reads."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from drivers.camera.calibration_file import Calibration, matrix_of, write_calibration
from drivers.camera.recording import CAMERA
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.types import CameraIntrinsics, RgbdFrame

_UNITS = 1000.0  # depth images' counts to the metre


class RecordingWriter:
    """Writes frames to a folder that `read_recording` reads."""

    def __init__(self, folder: Path, intrinsics: CameraIntrinsics) -> None:
        """Make the folder.

        Args:
            folder: Where to; must be empty or not there.
            intrinsics: Of all frames.

        Raises:
            InputError: The folder holds something, or cannot be made.
        """
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise InputError(f"{folder}: is not empty (choose another folder)")
        self._folder, self._intrinsics = folder, intrinsics
        try:
            for name in ("rgb", "depth"):
                (folder / name).mkdir(parents=True)
        except OSError as error:
            raise InputError(f"{folder}: cannot be made: {error.strerror}") from error
        size = intrinsics.width, intrinsics.height
        write_calibration(folder / CAMERA, Calibration(size, matrix_of(intrinsics), np.zeros(5), depth_units=_UNITS))

    def add(self, frame: RgbdFrame) -> None:
        """Write a frame, which must be later than the one before.

        Raises:
            InputError: The frame has other intrinsics than the recording, or cannot be written.
        """
        import cv2

        if frame.intrinsics != self._intrinsics:
            raise InputError(f"{self._folder}: the camera's intrinsics have changed")
        counts = np.rint(frame.depth * _UNITS)
        depth = np.where(counts <= 65535, counts, 0.0).astype(np.uint16)
        for kind, image in (("rgb", cv2.cvtColor(frame.rgb, cv2.COLOR_RGB2BGR)), ("depth", depth)):
            name = f"{kind}/{frame.stamp:.6f}.png"
            try:
                (self._folder / name).write_bytes(cv2.imencode(".png", image)[1].tobytes())
                with (self._folder / f"{kind}.txt").open("a", encoding="utf-8") as index:
                    index.write(f"{frame.stamp:.6f} {name}\n")
            except OSError as error:
                raise InputError(f"{self._folder / name}: cannot be written: {error.strerror}") from error


def record(latest: Callable[[], RgbdFrame | None], folder: Path, count: int, patience: float = 5.0) -> None:
    """Write a camera's next frames to a folder; blocks until it is done.

    Args:
        latest: The camera's ``frame``.
        folder: Where to; must be empty or not there.
        count: Number of frames.
        patience: How long to wait for each [s].

    Raises:
        InputError: The folder holds something, or cannot be written to.
        DeviceError: The camera delivers no more frames.
    """
    writer: RecordingWriter | None = None
    for frame in _next_frames(latest, count, patience):
        writer = writer or RecordingWriter(folder, frame.intrinsics)
        writer.add(frame)


def _next_frames(latest: Callable[[], RgbdFrame | None], count: int, patience: float) -> Iterator[RgbdFrame]:
    stamp, since = -np.inf, time.monotonic()
    while count:
        frame = latest()
        if frame is not None and frame.stamp > stamp:
            yield frame
            stamp, since, count = frame.stamp, time.monotonic(), count - 1
        elif time.monotonic() - since > patience:
            raise DeviceError(f"the camera delivers no frame for {patience:g} s (zavis doctor says what is wrong)")
        else:
            time.sleep(0.005)
