"""Driver of pan-tilt units of two CiA 402 drives on CANopen."""

from drivers.pan_tilt.device import CanPanTilt, open_pan_tilt
from drivers.pan_tilt.settings import HomingSettings, PanTiltSettings

__all__ = ["CanPanTilt", "HomingSettings", "PanTiltSettings", "open_pan_tilt"]
