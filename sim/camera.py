"""The simulated RGB-D camera on its pan-tilt unit."""

from __future__ import annotations

from sim.frame import SimFrame
from sim.scene import Scene
from zavis_bt.geometry import transform_camera_to_map
from zavis_bt.types import CameraSpec, Pose2D


class SimCamera:
    """Takes frames of a scene; a frame costs next to nothing until somebody looks at it."""

    def __init__(self, scene: Scene, spec: CameraSpec) -> None:
        self._scene, self._spec = scene, spec

    def capture(self, base: Pose2D, pan: float, tilt: float, stamp: float, odometry: Pose2D | None = None) -> SimFrame:
        """Return the frame a camera takes from here.

        Args:
            base: Where the base really is in the map.
            pan: Counter-clockwise from the base's heading [rad].
            tilt: Up from the horizon [rad].
            stamp: Time of capture [s].
            odometry: Where the robot takes the base to be, if not there; the frame says it was taken from there.
        """
        pose = transform_camera_to_map(base, pan, tilt, self._spec)
        believed = pose if odometry is None else transform_camera_to_map(odometry, pan, tilt, self._spec)
        depth_range = self._spec.depth_min, self._spec.depth_max
        return SimFrame(self._scene, self._spec.intrinsics, pose, believed, stamp, depth_range)
