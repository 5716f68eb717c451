"""A camera that plays a recording back."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from drivers.camera.device import CameraDevice
from drivers.camera.recording import RecordedFrame, read_recording
from drivers.camera.source import Capture, NamePlate
from drivers.settings import Settings, read_settings
from zavis_bt.protocols import DeviceContext


class RecordedSettings(Settings):
    """Settings of the driver ``recorded``."""

    folder: Path
    """The recording; a path that is not absolute begins in the current folder."""
    speed: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 1.0
    """Times the speed it was recorded at."""
    loop: bool = True
    """Whether it begins again at its end; else the last frame stays."""


def open_recorded(settings: Mapping[str, Any], context: DeviceContext) -> CameraDevice:
    """Open a recording as a camera.

    Raises:
        InputError: A setting is wrong, or it is no recording.
    """
    chosen = read_settings(RecordedSettings, settings, context.where)
    return CameraDevice(RecordedSource(chosen, context, read_recording(chosen.folder)), context)


class RecordedSource:
    """Delivers the frames of a recording at their pace."""

    def __init__(self, settings: RecordedSettings, context: DeviceContext, frames: tuple[RecordedFrame, ...]) -> None:
        self._settings, self._clock, self._frames = settings, context.clock, frames
        span = frames[-1].stamp - frames[0].stamp
        self._last_gap = span / (len(frames) - 1) if span > 0 else 1.0  # before it begins again [s]
        self._next, self._due = 0, 0.0

    def open(self) -> NamePlate:
        """Begin at the beginning."""
        self._next, self._due = 0, time.monotonic()
        figures = {"frames recorded": str(len(self._frames)), "speed": f"{self._settings.speed:g} times"}
        return NamePlate(f"recording {self._settings.folder}", figures=figures)

    def capture(self, timeout: float) -> Capture | None:
        """Wait until the next frame is due."""
        if self._next == len(self._frames):
            time.sleep(timeout)
            return None
        wait = self._due - time.monotonic()
        time.sleep(min(max(wait, 0.0), timeout))
        if wait > timeout:
            return None
        frame = self._frames[self._next]
        self._advance(frame)
        return Capture(self._clock.now(), frame.intrinsics, frame.pixels)

    def close(self) -> None:
        """Nothing is held open."""

    def _advance(self, frame: RecordedFrame) -> None:
        self._next += 1
        if self._next < len(self._frames):
            gap = self._frames[self._next].stamp - frame.stamp
        else:
            gap = self._last_gap
            if self._settings.loop:
                self._next = 0
        self._due = max(self._due + gap / self._settings.speed, time.monotonic() - gap)
