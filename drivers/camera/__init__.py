"""RGB-D cameras: the simulator's network camera, RealSense, stereo pairs, and recordings."""

from drivers.camera.annotated import AnnotatedFrame
from drivers.camera.device import CameraDevice
from drivers.camera.sim_source import open_sim

__all__ = ["AnnotatedFrame", "CameraDevice", "open_sim"]
