"""A robot in a world: what a mission drives, and what only the simulation knows."""

from __future__ import annotations

import numpy as np

from sim.base import SimBase
from sim.camera import SimCamera
from sim.clock import SimClock
from sim.lidar import SimLidar
from sim.noise import NoiseSettings, RangeNoise, stream
from sim.pan_tilt import SimPanTilt
from sim.put_down import put_down
from sim.robot import MountedCamera, SimRobot
from sim.scene import Scene
from sim.world import World
from zavis_bt.errors import InputError
from zavis_bt.types import Pose2D, RobotSpec

_MEMORY = 1.0  # so long ago poses and angles are still known [s]


class Simulation:
    """A robot put down in a world. The same world, robot, start, seed and commands give the same run."""

    def __init__(
        self,
        world: World,
        spec: RobotSpec,
        start: Pose2D,
        seed: int = 0,
        *,
        noise: NoiseSettings | None = None,
        real_time: bool = False,
        watchdog: float = 0.5,
    ) -> None:
        """Put a robot down.

        Args:
            world: Where.
            spec: The robot's model.
            start: Its first pose; the odometry begins there.
            seed: Of all randomness, 0 or more.
            noise: Imperfections of the devices; none by default.
            real_time: Let simulated time pass as fast as the wall clock's.
            watchdog: Time without a command after which the base slows down to rest [s].

        Raises:
            InputError: The robot does not fit at the start; the seed is negative.
        """
        if seed < 0:
            raise InputError(f"seed: {seed} is negative (0 or more)")
        noise = noise or NoiseSettings()
        memory = max(1 / min(spec.lidar.rate, spec.camera.rate), _MEMORY)
        self._seed = seed
        self._physics = put_down(world, spec.footprint, start, noise, self.rng("odometry"), memory)
        self.clock = SimClock(self._physics, real_time=real_time)
        pan_tilt = SimPanTilt(self._physics, spec.pan_tilt, memory=memory)
        camera = SimCamera(Scene.of(world), spec.camera)
        self.robot = SimRobot(
            spec,
            SimBase(self._physics, spec.limits, watchdog=watchdog),
            pan_tilt,
            SimLidar(self._physics, world.ray_caster, spec.lidar, RangeNoise(noise, seed)),
            MountedCamera(camera, self._physics, pan_tilt, spec.camera.rate),
        )

    @property
    def truth(self) -> Pose2D:
        """The base's true pose in the map."""
        return Pose2D(*self._physics.motion.true)

    @property
    def collisions(self) -> int:
        """Contacts with obstacles so far."""
        return self._physics.motion.contact.number

    @property
    def path_length(self) -> float:
        """Length of the true path so far [m]."""
        return self._physics.motion.travelled

    def rng(self, name: str) -> np.random.Generator:
        """Return a new random generator for the consumer ``name``, which follows from the seed and the name."""
        return stream(self._seed, name)
