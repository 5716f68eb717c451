"""Frames that say what they show."""

from __future__ import annotations

from drivers.camera.frame_message import Annotation
from zavis_bt.types import RgbdFrame


class AnnotatedFrame(RgbdFrame):
    """A frame of the simulator's camera, with what is really in it, for simulated perception."""

    annotations: tuple[Annotation, ...] = ()
