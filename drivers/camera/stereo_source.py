"""A stereo pair: two webcams, or one device that delivers left and right side by side."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from drivers.camera.calibration_file import read_stereo
from drivers.camera.device import CameraDevice
from drivers.camera.source import Capture, NamePlate
from drivers.camera.stereo_depth import StereoDepth
from drivers.camera.video import Video, VideoName
from drivers.settings import Settings, read_settings
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext


class StereoSettings(Settings):
    """Settings of the driver ``stereo``."""

    left: VideoName
    """The left camera, or the one that delivers left and right side by side."""
    right: VideoName | None = None
    """The right camera; none if ``left`` delivers both."""
    calibration: Path
    """File of the pair in OpenCV's YAML, as ``zavis camera calibrate`` writes it."""
    fps: Annotated[float, Field(gt=0, le=1000)] | None = None
    """What to ask the cameras for [Hz]."""
    latency: Annotated[float, Field(ge=0, le=2)] = 0.0
    """From exposure until the image is here [s]."""
    block_size: Annotated[int, Field(ge=1, le=31)] = 5
    """Side of the blocks compared, odd [px]."""
    uniqueness: Annotated[int, Field(ge=0, le=100)] = 10
    """By how many percent the best match must beat the second best."""

    @field_validator("block_size")
    @classmethod
    def _is_odd(cls, size: int) -> int:
        if size % 2 == 0:
            raise ValueError("should be odd")
        return size


def open_stereo(settings: Mapping[str, Any], context: DeviceContext) -> CameraDevice:
    """Open a stereo pair.

    Raises:
        InputError: A setting or the calibration is wrong.
        DeviceError: A camera cannot be opened.
    """
    chosen, camera = read_settings(StereoSettings, settings, context.where), context.spec.camera
    depth = StereoDepth(
        read_stereo(chosen.calibration),
        (camera.intrinsics.width, camera.intrinsics.height),
        camera.depth_min,
        camera.depth_max,
        chosen.block_size,
        chosen.uniqueness,
    )
    return CameraDevice(StereoSource(chosen, context, depth), context)


class StereoSource:
    """Takes pairs of images; their depth is computed when somebody looks at it."""

    def __init__(self, settings: StereoSettings, context: DeviceContext, depth: StereoDepth) -> None:
        self._settings, self._context, self._depth = settings, context, depth
        self._videos: list[Video] = []
        self._due = 0.0

    def open(self) -> NamePlate:
        """Open both cameras."""
        settings, (width, height) = self._settings, self._depth.calibration.size
        names = [settings.left] if settings.right is None else [settings.left, settings.right]
        size = width * (3 - len(names)), height
        try:
            for name in names:
                self._videos.append(Video(name, self._context.where, size, settings.fps))
        except DeviceError:
            self.close()
            raise
        self._due = time.monotonic()
        figures = {
            "cameras": " and ".join(map(str, names)) + " side by side" * (len(names) == 1),
            "baseline": f"{1000 * self._depth.calibration.baseline:.1f} mm",
            "nearest depth": f"{self._depth.nearest:.2f} m",
            "calibration error": f"{self._depth.calibration.rms:.2f} px",
        }
        return NamePlate("stereo pair", figures=figures)

    def capture(self, timeout: float) -> Capture | None:
        """Take the next pair; images that come faster than wanted are passed over."""
        wait, is_live = self._due - time.monotonic(), self._videos[0].is_live
        if not is_live:  # a file waits for us, a camera does not
            time.sleep(min(max(wait, 0.0), timeout))
            if wait > timeout:
                return None
        for video in self._videos:
            video.grab()
        stamp = self._context.clock.now() - self._settings.latency
        if is_live and wait > 0:
            return None
        period = 1 / self._context.spec.camera.rate
        self._due = max(self._due + period, time.monotonic() - period)
        left, right = self._images()
        return Capture(stamp, self._depth.intrinsics, partial(self._depth, left, right))

    def close(self) -> None:
        """Release the cameras."""
        for video in self._videos:
            video.close()
        self._videos.clear()

    def _images(self) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
        images = [video.retrieve() for video in self._videos]
        if len(images) == 1:
            middle = images[0].shape[1] // 2
            images = [images[0][:, :middle], images[0][:, middle:]]
        width, height = self._depth.calibration.size
        for image in images:
            if image.shape[:2] != (height, width):
                found = f"{image.shape[1]} x {image.shape[0]}"
                raise DeviceError(
                    f"{self._context.where}: delivers {found} for each eye, but was calibrated at {width} x {height} "
                    "(calibrate again, or with the size it delivers)"
                )
        return images[0], images[1]
