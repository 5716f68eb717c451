"""Putting a robot down in a world."""

from __future__ import annotations

import numpy as np

from sim.collision import Body, is_free
from sim.kinematics import Ground, OdometryError
from sim.noise import NoiseSettings
from sim.physics import Physics
from sim.world import World
from zavis_bt.errors import InputError
from zavis_bt.types import Footprint, GridMap, Pose2D


def put_down(
    world: World, footprint: Footprint, start: Pose2D, noise: NoiseSettings, rng: np.random.Generator, memory: float
) -> Physics:
    """Return the physics of a robot that stands there.

    Args:
        world: Where.
        footprint: Its outline.
        start: Its pose in the map; odometry begins there.
        noise: Of its odometry.
        rng: For that noise.
        memory: How long ago its poses must still be known [s].

    Raises:
        InputError: It does not fit there.
    """
    grid = world.grid
    ground = Ground(world.occupied, float(grid.resolution), float(grid.origin[0]), float(grid.origin[1]))
    body = Body.of(footprint, grid.resolution)
    _check_start(world, ground, body, start)
    walk = (noise.rotation_per_radian, noise.rotation_per_metre, noise.distance_per_metre, noise.distance_per_radian)
    error = OdometryError(any(walk), *map(float, walk))
    return Physics(ground, body, start, error=error, rng=rng, memory=memory)


def _check_start(world: World, ground: Ground, body: Body, start: Pose2D) -> None:
    u = (start.x - ground.x0) / ground.resolution - 0.5
    v = (start.y - ground.y0) / ground.resolution - 0.5
    if is_free(ground.occupied, body, u, v, start.yaw):
        return
    place = f"{world.path or world.name}: start ({start.x:g}, {start.y:g})"
    if not _inside(world.grid, start):
        raise InputError(f"{place}: is outside the map (a free place inside is needed)")
    reach = body.reach * ground.resolution
    raise InputError(f"{place}: the robot does not fit there (obstacles are closer than its outline of {reach:.2f} m)")


def _inside(grid: GridMap, pose: Pose2D) -> bool:
    row, col = grid.to_cells(np.array([[pose.x, pose.y]]))[0]
    return bool(0 <= row < grid.shape[0] and 0 <= col < grid.shape[1])
