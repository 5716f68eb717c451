"""Values that pass between the rooms of the framework.

SI units, radians, yaw counter-clockwise. The map frame has x right, y up, z away from the floor; a pose "in the map"
is a pose in that frame. Grids are indexed ``[row, col]`` = ``[y, x]``. Camera frames are optical: x right, y down,
z forward; pixels are ``(u, v)`` = (column, row), pixel centres at half integers.
"""

from zavis_bt.types.devices import DeviceReport
from zavis_bt.types.grid import FREE, OCCUPIED, UNKNOWN, GridMap
from zavis_bt.types.mission import Event, MissionResult, NodeState, NodeStatus, Observed
from zavis_bt.types.motion import BaseState, FloatArray, PanTiltState, Path, Pose2D, Twist2D, wrap_angle
from zavis_bt.types.robot import BaseLimits, CameraSpec, Footprint, LidarSpec, PanTiltSpec, RobotSpec
from zavis_bt.types.semantics import Answer, Candidate, Landmark, LandmarkSighting, Percept, Viewpoint, entropy
from zavis_bt.types.sensing import UNKNOWN_CLASS, Box, CameraIntrinsics, Detection, LaserScan, RgbdFrame

__all__ = [
    "FREE",
    "OCCUPIED",
    "UNKNOWN",
    "UNKNOWN_CLASS",
    "Answer",
    "BaseLimits",
    "BaseState",
    "Box",
    "CameraIntrinsics",
    "CameraSpec",
    "Candidate",
    "Detection",
    "DeviceReport",
    "Event",
    "FloatArray",
    "Footprint",
    "GridMap",
    "Landmark",
    "LandmarkSighting",
    "LaserScan",
    "LidarSpec",
    "MissionResult",
    "NodeState",
    "NodeStatus",
    "Observed",
    "PanTiltSpec",
    "PanTiltState",
    "Path",
    "Percept",
    "Pose2D",
    "RgbdFrame",
    "RobotSpec",
    "Twist2D",
    "Viewpoint",
    "entropy",
    "wrap_angle",
]
