"""Frames that say what they show."""

from __future__ import annotations

from drivers.camera.frame_message import Annotation
from drivers.camera.source import Pixels
from zavis_bt.types import CameraIntrinsics, FloatArray, RgbdFrame


class AnnotatedFrame(RgbdFrame):
    """A frame of the simulator's camera, with what is really in it, for simulated perception."""

    def __init__(
        self,
        intrinsics: CameraIntrinsics,
        transform_camera_to_map: FloatArray,
        stamp: float,
        pixels: Pixels,
        annotations: tuple[Annotation, ...],
    ) -> None:
        """Describe a frame, as `RgbdFrame` does, and what it shows, nearest first."""
        super().__init__(intrinsics, transform_camera_to_map, stamp, pixels)
        self.annotations = annotations
