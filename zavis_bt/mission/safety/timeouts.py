"""From what age on what a device says is too old."""

from __future__ import annotations

from zavis_bt.mission.safety.settings import SafetySettings
from zavis_bt.types import CameraSpec, LidarSpec

_PERIODS = 2.5  # a device that is so many of its periods late has left out two


def scan_timeout(settings: SafetySettings, lidar: LidarSpec) -> float:
    """Return the age from which on a scan is too old [s]."""
    return max(settings.scan_timeout, _PERIODS / lidar.rate)


def frame_timeout(settings: SafetySettings, camera: CameraSpec) -> float:
    """Return the age from which on a frame is too old [s]."""
    return max(settings.frame_timeout, _PERIODS / camera.rate)
