"""What tests of cameras share: contexts, waiting, frames of a simulated room, a stereo pair in it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np

from drivers.camera.calibration_file import StereoCalibration, matrix_of
from sim.frame import SimFrame
from sim.scene import Scene
from sim.world import Furniture, World, WorldObject
from zavis_bt.geometry import back_project, transform_camera_to_map, transform_points
from zavis_bt.mission import WallClock
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import (
    FREE,
    OCCUPIED,
    BaseLimits,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    GridMap,
    LidarSpec,
    PanTiltSpec,
    Pose2D,
    RobotSpec,
)

BASELINE = 0.08
DEPTHS = 0.4, 7.0


def camera_spec(width: int = 64, height: int = 48, rate: float = 20.0) -> CameraSpec:
    return CameraSpec(CameraIntrinsics.from_fov(width, height, math.radians(60)), 0.0, 0.9, *DEPTHS, rate)


def robot_spec(camera: CameraSpec | None = None) -> RobotSpec:
    return RobotSpec(
        "disc",
        Footprint(0.36, 0.36, disc=True),
        BaseLimits(0.6, 0.3, 1.8, 1.0, 4.0),
        LidarSpec(181, math.pi, 0.05, 10.0, 10.0, Pose2D(0.1, 0.0), 0.3),
        PanTiltSpec(-math.pi, math.pi, -1.0, 1.0, 2.0, 8.0),
        camera or camera_spec(),
    )


def pose_at(stamp: float) -> np.ndarray:
    """A pose that tells the time it was asked for."""
    pose = np.eye(4)
    pose[0, 3] = stamp
    return pose


def context(camera: CameraSpec | None = None) -> DeviceContext:
    return DeviceContext("my.robot.yaml: devices.camera", robot_spec(camera), WallClock(), Pose2D(0.0, 0.0), pose_at)


def wait_for(condition: Callable[[], object], seconds: float = 20.0) -> bool:
    """Return whether it came true in time."""
    until = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > until:
            return False
        time.sleep(0.005)
    return True


def furnished_room() -> World:
    """6 m × 4 m, with a box of 1 m and mugs before the camera at (1, 2)."""
    states = np.full((84, 124), FREE, dtype=np.int8)
    states[:2], states[-2:], states[:, :2], states[:, -2:] = (OCCUPIED,) * 4
    furniture = Furniture("sofa_1", "sofa", 3.5, 2.3, 0.3, 0.8, 0.8, 0.7)
    mugs = (
        WorldObject("mug_1", "mug", 2.6, 1.6, 0.7, (0.2, 0.2, 0.2), None, "red"),
        WorldObject("mug_2", "mug", 3.5, 2.3, 0.7, (0.3, 0.3, 0.3), "sofa_1", "blue"),
    )
    return World("room", GridMap(states, 0.05, (-0.1, -0.1)), 2.5, (furniture,), mugs)


def stereo_views(camera: CameraSpec, x: float = 1.0, tilt: float = -0.15) -> tuple[SimFrame, SimFrame]:
    """Frames of the left and the right eye, which is `BASELINE` to the right."""
    scene = Scene.of(furnished_room())
    left = transform_camera_to_map(Pose2D(x, 2.0), 0.0, tilt, camera)
    right = left.copy()
    right[:3, 3] += BASELINE * left[:3, 0]
    frames = [SimFrame(scene, camera.intrinsics, pose, pose, 0.0, (0.05, 20.0)) for pose in (left, right)]
    return frames[0], frames[1]


def textured(frame: SimFrame) -> np.ndarray:
    """Return the frame's image (h, w, 3), blue first, with a pattern that sticks to what is seen: (h, w, 3)."""
    rows, columns = np.indices(frame.depth.shape)
    pixels = np.column_stack((columns.ravel(), rows.ravel())) + 0.5
    optical = back_project(pixels, frame.depth.ravel().astype(np.float64), frame.intrinsics)
    points = transform_points(frame.transform_camera_to_map, optical)
    rng, pattern = np.random.default_rng(5), np.zeros(len(points))
    for scale in (15.0, 30.0, 60.0):
        for _ in range(4):
            pattern += np.sin(points @ rng.normal(0.0, scale, 3) + rng.uniform(0.0, 6.0))
    shade = (0.75 + 0.07 * pattern).clip(0.2, 1.3).reshape(*frame.depth.shape, 1)
    return (frame.rgb[:, :, ::-1] * shade).clip(0, 255).astype(np.uint8)


def stereo_calibration(camera: CameraSpec) -> StereoCalibration:
    """What a calibration of `stereo_views` says: two cameras without distortion, side by side."""
    matrix, none, straight = matrix_of(camera.intrinsics), np.zeros(5), np.eye(3)
    projection = np.column_stack((matrix, np.zeros(3)))
    other = projection.copy()
    other[0, 3] = -BASELINE * matrix[0, 0]
    disparity_to_depth = np.eye(4)
    size = camera.intrinsics.width, camera.intrinsics.height
    shift = np.array([-BASELINE, 0.0, 0.0])
    return StereoCalibration(
        size, matrix, none, matrix, none, straight, shift, straight, straight, projection, other, disparity_to_depth
    )
