"""Intel RealSense depth cameras, through pyrealsense2."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from drivers.camera.clock_offset import ClockOffset
from drivers.camera.device import CameraDevice
from drivers.camera.source import Capture, NamePlate
from drivers.settings import Settings, read_settings
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import CameraIntrinsics

_SILENCE = 5.0  # a camera that delivers nothing for so long is started anew [s]; its own start takes up to 2 s
_OLDEST = 1.0  # a time of capture further back than that comes from a clock that is not this computer's [s]


class RealSenseSettings(Settings):
    """Settings of the driver ``realsense``."""

    serial: str | None = None
    """Serial number; any camera if not given."""
    fps: Annotated[int, Field(ge=1, le=300)] = 30
    """Images a second to ask the camera for, of which as many are used as the robot's camera delivers [Hz]."""
    depth_size: tuple[int, int] | None = None
    """Width and height to ask the depth sensor for; its own choice if not given. Depth is aligned to colour."""


def open_realsense(settings: Mapping[str, Any], context: DeviceContext) -> CameraDevice:
    """Open a RealSense camera.

    Raises:
        InputError: A setting is wrong.
        DeviceError: There is no such camera, it cannot deliver what is asked for, or pyrealsense2 is missing.
    """
    chosen = read_settings(RealSenseSettings, settings, context.where)
    library = load_library(context.where)
    return CameraDevice(RealSenseSource(chosen, context, library, library.context()), context)


def load_library(where: str) -> Any:
    """Return pyrealsense2.

    Raises:
        DeviceError: It is not installed, or does not work here.
    """
    try:
        import pyrealsense2
    except ImportError as error:
        remedy = "pip install 'zavis_bt[robot]'" if isinstance(error, ModuleNotFoundError) else str(error)
        raise DeviceError(f"{where}: the library of RealSense cameras cannot be loaded ({remedy})") from None
    return pyrealsense2


class RealSenseSource:
    """Takes colour images and depth aligned to them."""

    def __init__(self, settings: RealSenseSettings, context: DeviceContext, library: Any, devices: Any) -> None:
        """Set up; nothing is opened.

        Args:
            settings: Which camera, and how.
            context: The robot around it.
            library: pyrealsense2.
            devices: Its ``context``: what cameras there are.
        """
        self._settings, self._context, self._rs, self._devices = settings, context, library, devices
        self._pipeline: Any = None
        self._offset = ClockOffset(60.0)
        self._due = self._heard = 0.0

    def open(self) -> NamePlate:
        """Start the camera."""
        device = self._find()
        self._serial = self._info(device, "serial_number")
        pipeline = self._rs.pipeline(self._devices)
        try:
            profile = pipeline.start(self._wishes())
        except RuntimeError as error:
            raise DeviceError(f"{self._context.where}: {self._plain(error)}") from error
        self._pipeline, self._align = pipeline, self._rs.align(self._rs.stream.color)
        self._intrinsics = _intrinsics(profile.get_stream(self._rs.stream.color).as_video_stream_profile().intrinsics)
        self._units = profile.get_device().first_depth_sensor().get_depth_scale()
        self._offset, self._due, self._heard = ClockOffset(60.0), 0.0, time.monotonic()
        figures = {"USB": self._info(device, "usb_type_descriptor"), "depth unit": f"{1000 * self._units:g} mm"}
        name, firmware = self._info(device, "name"), self._info(device, "firmware_version")
        return NamePlate(name, firmware, self._serial, {key: value for key, value in figures.items() if value})

    def capture(self, timeout: float) -> Capture | None:
        """Take the next images; those that come faster than wanted are passed over."""
        try:
            arrived, frames = self._pipeline.try_wait_for_frames(int(1000 * timeout))
            now, read = time.monotonic(), self._context.clock.now()
            if arrived:
                return self._taken(frames, now, read)
        except RuntimeError as error:
            raise DeviceError(f"{self._context.where}: {self._plain(error)}") from error
        if now - self._heard > _SILENCE:
            raise DeviceError(f"{self._context.where}: {self._why_silent()}")
        return None

    def close(self) -> None:
        """Stop the camera."""
        pipeline, self._pipeline = self._pipeline, None
        if pipeline is not None:
            with contextlib.suppress(RuntimeError):  # the camera has gone already
                pipeline.stop()

    def _taken(self, frames: Any, now: float, read: float) -> Capture | None:
        self._heard = now
        stamp = self._stamp(frames, read)
        if now < self._due:
            return None
        period = 1 / self._context.spec.camera.rate
        self._due = max(self._due + period, now - period)
        aligned = self._align.process(frames)
        colour, depth = aligned.get_color_frame(), aligned.get_depth_frame()
        if not colour or not depth:
            return None
        # Copies: the library has few buffers, and delivers nothing once they are all held.
        rgb, counts = np.array(colour.get_data()), np.array(depth.get_data())
        return Capture(stamp, self._intrinsics, partial(self._pixels, rgb, counts))

    def _pixels(
        self, rgb: NDArray[np.uint8], counts: NDArray[np.uint16]
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        camera, depth = self._context.spec.camera, counts * np.float32(self._units)
        depth[(depth < camera.depth_min) | (depth > camera.depth_max)] = 0.0
        return rgb, depth

    def _stamp(self, frames: Any, read: float) -> float:
        """Return when the frames were taken, on the mission's clock [s]."""
        taken: float = frames.get_timestamp() / 1000
        if frames.get_frame_timestamp_domain() != self._rs.timestamp_domain.hardware_clock:
            age = time.time() - taken
            if 0 <= age < _OLDEST:
                return read - age
        self._offset.add(taken, read)
        return min(self._offset(taken), read)

    def _wishes(self) -> Any:
        rs, wanted, size = self._rs, self._context.spec.camera.intrinsics, self._settings.depth_size or (0, 0)
        config = rs.config()
        config.enable_device(self._serial)
        config.enable_stream(rs.stream.color, wanted.width, wanted.height, rs.format.rgb8, self._settings.fps)
        config.enable_stream(rs.stream.depth, *size, rs.format.z16, self._settings.fps)
        return config

    def _find(self) -> Any:
        found = {self._info(device, "serial_number"): device for device in self._devices.query_devices()}
        wanted, where = self._settings.serial, self._context.where
        if not found:
            raise DeviceError(f"{where}: no RealSense camera is connected (plug it into a USB 3 port)")
        if wanted is not None and wanted not in found:
            raise DeviceError(f"{where}: no RealSense camera has the serial number {wanted} ({', '.join(found)} has)")
        return found[wanted] if wanted is not None else next(iter(found.values()))

    def _why_silent(self) -> str:
        self._find()
        return f"no image for {_SILENCE:g} s though it is connected (try another USB 3 port or cable)"

    def _plain(self, error: RuntimeError) -> str:
        text = " ".join(str(error).split())
        if "resolve" in text:
            wanted = self._context.spec.camera.intrinsics
            asked = f"{wanted.width} x {wanted.height} at {self._settings.fps} Hz"
            return f"the camera cannot deliver {asked} (choose another 'fps' or 'image'; on USB 2 it delivers less)"
        if "busy" in text.lower():
            return "another program uses the camera (close it)"
        return text

    def _info(self, device: Any, name: str) -> str:
        key = getattr(self._rs.camera_info, name)
        return str(device.get_info(key)) if device.supports(key) else ""


def _intrinsics(model: Any) -> CameraIntrinsics:
    """Return the pinhole model of the library's, which counts pixels from the middle of the first one."""
    return CameraIntrinsics(model.width, model.height, model.fx, model.fy, model.ppx + 0.5, model.ppy + 0.5)
