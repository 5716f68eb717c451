"""RGB-D cameras: the simulator's network camera, RealSense, stereo pairs, and recordings."""

from drivers.camera.annotated import AnnotatedFrame
from drivers.camera.device import CameraDevice
from drivers.camera.realsense_source import open_realsense
from drivers.camera.recorded_source import open_recorded
from drivers.camera.recording_writer import RecordingWriter, record
from drivers.camera.sim_source import open_sim
from drivers.camera.stereo_source import open_stereo

__all__ = [
    "AnnotatedFrame",
    "CameraDevice",
    "RecordingWriter",
    "open_realsense",
    "open_recorded",
    "open_sim",
    "open_stereo",
    "record",
]
