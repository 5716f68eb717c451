"""The last word on every motion: checked outside the tree, whatever a behaviour asked for."""

from zavis_bt.mission.safety.base import SafeBase
from zavis_bt.mission.safety.braking import BrakingRule, Verdict
from zavis_bt.mission.safety.pan_tilt import SafePanTilt
from zavis_bt.mission.safety.robot import SafeRobot
from zavis_bt.mission.safety.settings import SafetySettings
from zavis_bt.mission.safety.timeouts import frame_timeout, scan_timeout

__all__ = [
    "BrakingRule",
    "SafeBase",
    "SafePanTilt",
    "SafeRobot",
    "SafetySettings",
    "Verdict",
    "frame_timeout",
    "scan_timeout",
]
