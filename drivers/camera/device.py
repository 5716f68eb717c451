"""A camera as a device: its own thread, its latest frame, and what it says of itself."""

from __future__ import annotations

import threading
from collections import deque
from functools import partial

import numpy as np
from numpy.typing import NDArray

from drivers.camera.annotated import AnnotatedFrame
from drivers.camera.source import Capture, Pixels, Source
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import DeviceReport, RgbdFrame

_PATIENCE = 0.1  # at most so long a closing device waits for its source [s]
_FIRST_PAUSE, _LONGEST_PAUSE = 0.2, 2.0  # between attempts to reconnect [s]
_SILENCE = 2.0  # no frame for so long is a problem, or for five frames if they come slower [s]
_COUNTED = 50  # frames that the rate is measured over


class CameraDevice:
    """A camera that keeps its latest frame. After a loss it tries again and again to reconnect."""

    def __init__(self, source: Source, context: DeviceContext) -> None:
        """Open the camera and let its frames come.

        Args:
            source: Where the images come from; owned from now on.
            context: The robot around it.

        Raises:
            DeviceError: It cannot be opened.
        """
        self._source, self._context = source, context
        self._plate = source.open()
        self._frame: RgbdFrame | None = None
        self._stamps: deque[tuple[float, float]] = deque(maxlen=_COUNTED)  # times of capture and of arrival
        self._opened = context.clock.now()
        self._fault, self._losses = "", 0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="camera", daemon=True)
        self._thread.start()

    def frame(self) -> RgbdFrame | None:
        """Return the latest frame, or None if there was none yet."""
        return self._frame

    def report(self) -> DeviceReport:
        """Return its name plate, rate and age of its frames, and what is wrong."""
        plate, stamps = self._plate, tuple(self._stamps)
        figures = dict(plate.figures)
        if stamps:
            figures["age of the latest frame"] = f"{self._context.clock.now() - stamps[-1][0]:.2f} s"
            figures["latency"] = f"{1000 * max(read - taken for taken, read in stamps):.0f} ms at most"
        if len(stamps) > 1 and stamps[-1][1] > stamps[0][1]:
            figures["rate"] = f"{(len(stamps) - 1) / (stamps[-1][1] - stamps[0][1]):.1f} Hz"
        figures["lost"] = f"{self._losses} times"
        return DeviceReport(plate.model, plate.firmware, plate.serial, figures, self._problems())

    def close(self) -> None:
        """Release the camera; never raises, may be called twice."""
        self._stop.set()
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout=_LONGEST_PAUSE)

    def _problems(self) -> tuple[str, ...]:
        if self._fault:
            return (self._fault,)
        frame, now = self._frame, self._context.clock.now()
        silent = now - (self._opened if frame is None else frame.stamp)
        if silent <= max(_SILENCE, 5 / self._context.spec.camera.rate):
            return ()
        return (f"{self._context.where}: no frame for {silent:.1f} s (is the camera frozen? unplug it, plug it in)",)

    def _run(self) -> None:
        try:
            while not self._stop.is_set():
                try:
                    capture = self._source.capture(_PATIENCE)
                except DeviceError as error:
                    self._recover(error)
                else:
                    if capture is not None:
                        self._take(capture)
        finally:
            self._source.close()

    def _take(self, capture: Capture) -> None:
        if self._frame is not None and capture.stamp <= self._frame.stamp:  # the other end's time stands still
            return
        pose, pixels = self._context.camera_pose(capture.stamp), partial(_read_only, capture.pixels)
        if capture.annotations is None:
            self._frame = RgbdFrame(capture.intrinsics, pose, capture.stamp, pixels)
        else:
            self._frame = AnnotatedFrame(capture.intrinsics, pose, capture.stamp, pixels, capture.annotations)
        self._stamps.append((capture.stamp, self._context.clock.now()))

    def _recover(self, error: DeviceError) -> None:
        """Reconnect, with growing pauses between the attempts."""
        self._fault, self._losses = str(error), self._losses + 1
        self._source.close()
        pause = _FIRST_PAUSE
        while not self._stop.wait(pause):
            try:
                self._plate = self._source.open()
            except DeviceError as failure:
                self._fault = str(failure)
                pause = min(2 * pause, _LONGEST_PAUSE)
            else:
                self._fault = ""
                self._stamps.clear()
                return


def _read_only(pixels: Pixels) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    images = pixels()
    for image in images:
        image.setflags(write=False)
    return images
