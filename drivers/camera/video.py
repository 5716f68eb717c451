"""Images from webcams, video files and streams, through OpenCV."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivers.camera.calibration_file import Size
from zavis_bt.errors import DeviceError

VideoName = int | str
"""Number of a webcam, ``/dev/video…``, a file, files numbered as in ``left_%03d.png``, or a stream's address."""


class Video:
    """One opened video."""

    def __init__(self, name: VideoName, where: str, size: Size | None = None, rate: float | None = None) -> None:
        """Open it.

        Args:
            name: What to open.
            where: Place in the robot file or on the command line, to begin error messages with.
            size: Width and height to ask a webcam for [px].
            rate: To ask a webcam for [Hz].

        Raises:
            DeviceError: It cannot be opened: one line with the remedy.
        """
        import cv2

        self.name, self._where = name, f"{where}: {name}"
        device = f"/dev/video{name}" if isinstance(name, int) else name
        self.is_live = device.startswith("/dev/") or "://" in device
        self._check_there(device)
        self._capture: Any = cv2.VideoCapture(device) if isinstance(name, str) else cv2.VideoCapture(name)
        if not self._capture.isOpened():
            remedy = "does another program use it?" if self.is_live else "is it a video, or files numbered as %03d?"
            self.close()
            raise DeviceError(f"{self._where}: OpenCV cannot open it ({remedy})")
        if self.is_live:
            self._wish(size, rate)

    @property
    def rate(self) -> float:
        """Images a second as it says itself [Hz]; 0 if it does not."""
        import cv2

        return float(self._capture.get(cv2.CAP_PROP_FPS))

    def grab(self) -> None:
        """Take the next image, without decoding it; waits for it.

        Raises:
            DeviceError: There are no more.
        """
        if not self._capture.grab():
            lost = "the camera has gone (is its cable plugged in?)" if self.is_live else "has ended"
            raise DeviceError(f"{self._where}: {lost}")

    def retrieve(self) -> NDArray[np.uint8]:
        """Return the image grabbed, (h, w, 3), blue first; it is the caller's.

        Raises:
            DeviceError: It cannot be decoded.
        """
        good, image = self._capture.retrieve()
        if not good:
            raise DeviceError(f"{self._where}: an image is damaged (is the cable sound?)")
        return np.asarray(image, dtype=np.uint8)

    def close(self) -> None:
        """Close it; may be called twice."""
        self._capture.release()

    def _check_there(self, device: str) -> None:
        if "://" in device or "%" in device:
            return
        if not Path(device).exists():
            remedy = "plug the camera in; 'ls /dev/video*' lists what is there" if self.is_live else "check the path"
            raise DeviceError(f"{self._where}: there is no {device} ({remedy})")

    def _wish(self, size: Size | None, rate: float | None) -> None:
        import cv2

        wishes = {cv2.CAP_PROP_BUFFERSIZE: 1.0}
        if size is not None:
            wishes |= {cv2.CAP_PROP_FRAME_WIDTH: float(size[0]), cv2.CAP_PROP_FRAME_HEIGHT: float(size[1])}
        if rate is not None:
            wishes[cv2.CAP_PROP_FPS] = rate
        for name, value in wishes.items():
            self._capture.set(name, value)
