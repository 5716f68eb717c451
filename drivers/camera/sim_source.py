"""The simulator's network camera (docs/camera_protocol.md)."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drivers.camera.clock_offset import ClockOffset
from drivers.camera.device import CameraDevice
from drivers.camera.frame_message import (
    NextRequest,
    NothingNew,
    WireFrame,
    header_message,
    read_frame,
)
from drivers.camera.pixels import decode_pixels
from drivers.camera.sim_line import ANSWER, SimLine
from drivers.camera.sim_pixels import PixelLine
from drivers.camera.source import Capture, NamePlate
from drivers.camera.wire import Kind, Message, WireError
from drivers.settings import Settings, read_settings
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext

_WAIT = 0.5  # so long the server may wait for a new frame [s]
_AGAIN = 1.0  # an answer that takes longer got lost on the way [s]


class SimCameraSettings(Settings):
    """Settings of the driver ``sim``."""

    port: str = "tcp://localhost:8102"
    """Where the simulator's camera listens."""
    rgb: Literal["raw", "jpeg"] = "raw"
    depth: Literal["raw", "png"] = "raw"
    annotations: bool = True
    """Whether frames bring the ground truth that simulated perception needs."""
    pixels: Literal["ask", "send"] = "ask"
    """Whether a frame's images are rendered and fetched when somebody looks at them, or come with every frame."""


def open_sim(settings: Mapping[str, Any], context: DeviceContext) -> CameraDevice:
    """Open the simulator's camera.

    Raises:
        InputError: A setting is wrong.
        DeviceError: Nothing listens there, or it is no such camera.
    """
    return CameraDevice(SimSource(read_settings(SimCameraSettings, settings, context.where), context), context)


class SimSource:
    """Asks the simulator for one frame after the other."""

    def __init__(self, settings: SimCameraSettings, context: DeviceContext) -> None:
        self._settings, self._context = settings, context
        self._where = f"{context.where}: {settings.port}"
        self._line: SimLine | None = None
        self._pixel_line: PixelLine | None = None  # if frames come without pixels
        self._offset, self._number = ClockOffset(), 0
        self._due = 0.0  # when the next request is, on time.monotonic [s]
        self._asked: float | None = None  # when that was sent which is not answered yet
        self._silent_since = 0.0

    def open(self) -> NamePlate:
        """Connect and ask who is there."""
        self._line = SimLine(self._settings.port, self._context)
        self._offset, self._number, self._asked = ClockOffset(), 0, None
        try:
            identity = self._line.identify("frames")
            if self._settings.pixels == "ask":
                self._pixel_line = PixelLine(SimLine(self._settings.port, self._context))
        except DeviceError:
            self.close()
            raise
        self._silent_since = time.monotonic()
        figures = {"rate of the server": f"{identity.rate:g} Hz"}
        return NamePlate(identity.model, identity.firmware, identity.serial, figures)

    def capture(self, timeout: float) -> Capture | None:
        """Ask for the next frame when it is due, and wait for it."""
        assert self._line is not None
        if self._pixel_line is not None and self._pixel_line.fault:
            raise DeviceError(self._pixel_line.fault)
        if self._asked is None:
            wait = self._due - time.monotonic()
            time.sleep(min(max(wait, 0.0), timeout))
            if wait > timeout:
                return None
            self._ask(self._line)
        for message in self._line.receive(timeout):
            self._asked, self._silent_since = None, time.monotonic()
            if (frame := self._frame(message)) is not None:
                return frame
        self._check_silence()
        return None

    def close(self) -> None:
        """Disconnect."""
        if self._pixel_line is not None:
            self._pixel_line.close()
        if self._line is not None:
            self._line.close()
        self._line = self._pixel_line = None

    def _ask(self, line: SimLine) -> None:
        now, period = time.monotonic(), 1 / self._context.spec.camera.rate
        self._due = max(self._due + period, now)
        self._asked = now
        options = self._settings
        request = NextRequest(
            after=self._number,
            wait=_WAIT,
            rgb=options.rgb,
            depth=options.depth,
            annotations=options.annotations,
            pixels="keep" if options.pixels == "ask" else "send",
        )
        line.send(header_message(Kind.NEXT, request))

    def _frame(self, message: Message) -> Capture | None:
        assert self._line is not None
        if message.kind == Kind.NOTHING_NEW:
            self._offset.add(self._line.read(NothingNew, message).now, self._line.heard)
            return None
        try:
            frame = read_frame(message)
        except WireError as error:
            raise DeviceError(f"{self._where}: sends a frame that is none: {error}") from None
        self._offset.add(frame.now, self._line.heard)
        if frame.number <= self._number:
            return None
        self._number = frame.number
        stamp = min(self._offset(frame.stamp), self._context.clock.now())
        pixels = partial(self._pixels, frame, self._pixel_line)
        return Capture(stamp, frame.intrinsics, pixels, frame.annotations)

    def _pixels(self, frame: WireFrame, line: PixelLine | None) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Return a frame's images, from where they are: called by whoever looks at it."""
        full = line.fetch(frame) if frame.is_kept and line is not None else frame
        try:
            return decode_pixels(full.rgb, full.depth, full.intrinsics)
        except WireError as error:
            raise DeviceError(f"{self._where}: {error}") from None

    def _check_silence(self) -> None:
        now = time.monotonic()
        if now - self._silent_since > ANSWER:
            raise DeviceError(f"{self._where}: no answer for {ANSWER:g} s (is the simulator stopped?)")
        if self._asked is not None and now - self._asked > _AGAIN:
            self._asked = None
