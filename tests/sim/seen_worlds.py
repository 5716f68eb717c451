"""Small worlds to look at: one room of 6 m by 4 m with walls of 0.1 m, the camera at 0.9 m."""

from __future__ import annotations

import math

import numpy as np

from sim.camera import SimCamera
from sim.frame import InstanceView, SimFrame
from sim.scene import Scene
from sim.world import Furniture, World, WorldObject
from zavis_bt.types import FREE, OCCUPIED, CameraIntrinsics, CameraSpec, GridMap, Pose2D

SIZES = {"mug": (0.1, 0.1, 0.1), "cd": (0.105, 0.105, 0.004), "book": (0.2, 0.3, 0.05), "box": (0.4, 0.4, 0.4)}


def room(
    furniture: tuple[Furniture, ...] = (),
    objects: tuple[WorldObject, ...] = (),
    walls: tuple[slice, slice] | None = None,
) -> World:
    states = np.full((84, 124), FREE, dtype=np.int8)
    states[:2], states[-2:], states[:, :2], states[:, -2:] = (OCCUPIED,) * 4
    if walls is not None:
        states[walls] = OCCUPIED
    states.setflags(write=False)
    return World("room", GridMap(states, 0.05, (-0.1, -0.1)), 2.5, furniture, objects)


def piece(category: str, x: float, y: float, height: float, yaw: float = 0.0, size: float = 0.6) -> Furniture:
    return Furniture(f"{category}_1", category, x, y, yaw, size, size, height)


def thing(
    category: str, x: float, y: float, z: float = 0.0, on: str | None = None, colour: str | None = None, number: int = 1
) -> WorldObject:
    return WorldObject(f"{category}_{number}", category, x, y, z, SIZES[category], on, colour)


def camera_spec(width: int = 640, height: int = 480, depth_max: float = 8.0) -> CameraSpec:
    return CameraSpec(CameraIntrinsics.from_fov(width, height, math.radians(60)), 0.0, 0.9, 0.3, depth_max, 15.0)


def look(world: World, x: float, y: float, yaw: float = 0.0, tilt: float = 0.0, stamp: float = 0.0) -> SimFrame:
    return SimCamera(Scene.of(world), camera_spec()).capture(Pose2D(x, y, yaw), 0.0, tilt, stamp)


def rays_of(frame: SimFrame) -> np.ndarray:
    """Return (h * w, 3) the directions of the pixels' rays in the map, optical depth 1."""
    i, rotation = frame.intrinsics, frame.transform_camera_to_map[:3, :3]
    rows, cols = np.mgrid[0 : i.height, 0 : i.width]
    optical = np.stack(((cols + 0.5 - i.cx) / i.fx, (rows + 0.5 - i.cy) / i.fy, np.ones(cols.shape)), axis=-1)
    return optical.reshape(-1, 3) @ rotation.T


def snapshot(
    world: World,
    x: float,
    y: float,
    yaw: float = 0.0,
    tilt: float = 0.0,
    height: float = 0.9,
    size: tuple[int, int] = (96, 72),
) -> SimFrame:
    """Return a small frame of a camera that measures any depth."""
    spec = CameraSpec(CameraIntrinsics.from_fov(*size, math.radians(75)), 0.0, height, 1e-3, 1e3, 15.0)
    return SimCamera(Scene.of(world), spec).capture(Pose2D(x, y, yaw), 0.0, tilt, 0.0)


def middle(frame: SimFrame) -> int:
    """Return what is seen in the middle of the image."""
    return int(frame.surfaces[frame.surfaces.shape[0] // 2, frame.surfaces.shape[1] // 2])


def seen(frame: SimFrame, instance: str) -> InstanceView | None:
    return next((view for view in frame.instances if view.id == instance), None)
