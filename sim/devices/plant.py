"""The simulated robot's body, which runs by itself in real time while devices measure and move it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import numpy as np

from sim.camera import SimCamera
from sim.frame import SimFrame
from sim.kinematics import Motion
from sim.noise import NoiseSettings, RangeNoise, stream
from sim.physics import STEPS_PER_SECOND
from sim.put_down import put_down
from sim.scene import Scene
from sim.world import World
from zavis_bt.types import FloatArray, Pose2D, RobotSpec

_MEMORY = 1.0  # [s]
_LOST = 0.2  # [s] behind the wall clock from which on it is given up to catch up

Controller = Callable[[float], None]
Joints = Callable[[float], tuple[float, float]]


class Plant:
    """Base, LiDAR and camera of one robot in a world, and the time that passes there.

    A thread advances the world in steps of 20 ms at the wall clock's pace. Before each step the controllers are
    called, in the order added: that is where a device's firmware works.
    """

    def __init__(
        self, world: World, spec: RobotSpec, start: Pose2D, seed: int = 0, noise: NoiseSettings | None = None
    ) -> None:
        """Put a robot down; time stands still until `start`.

        Args:
            world: Where.
            spec: The robot's model.
            start: Its first pose in the map.
            seed: Of all randomness.
            noise: Imperfections; none by default.

        Raises:
            InputError: The robot does not fit at the start.
        """
        noise = noise or NoiseSettings()
        self.spec = spec
        self.controllers: list[Controller] = []
        """Called with the time [s] before each step."""
        self.joints: Joints = lambda stamp: (0.0, 0.0)
        """Pan and tilt [rad] at a time [s]; whoever plays the pan-tilt unit sets it."""
        self.charge = 1.0
        """State of charge, 0 to 1; set it to see what happens."""
        self.estop = False
        """Whether somebody has pressed the emergency stop; set it to see what happens."""
        self._physics = put_down(world, spec.footprint, start, noise, stream(seed, "odometry"), _MEMORY)
        self._caster, self._ranges_noise = world.ray_caster, RangeNoise(noise, seed)
        self._camera = SimCamera(Scene.of(world), spec.camera)
        self._scans = 0
        self._running = threading.Event()
        self._thread = threading.Thread(target=self._run, name="plant", daemon=True)

    @property
    def now(self) -> float:
        """Time since the start [s]."""
        return self._physics.now

    @property
    def motion(self) -> Motion:
        """True and odometry pose, velocities, contact: a snapshot."""
        return self._physics.motion

    def drive(self, linear: float, angular: float, linear_change: float, angular_change: float) -> None:
        """Approach a velocity from the next step on; for controllers.

        Args:
            linear: Forward [m/s].
            angular: Counter-clockwise [rad/s].
            linear_change: Bound of the acceleration [m/s²].
            angular_change: Bound of the acceleration [rad/s²].
        """
        self._physics.drive(linear, angular, linear_change, angular_change)

    def sweep(self, beams: int, angle_min: float, angle_increment: float) -> FloatArray:
        """Return the ranges (beams,) that the LiDAR measures now [m]; inf without return. May be called by any thread.

        Args:
            beams: Number of beams.
            angle_min: Direction of the first in the sensor's frame [rad].
            angle_increment: Angle between neighbours, counter-clockwise [rad].
        """
        lidar = self.spec.lidar
        sensor = Pose2D(*self.motion.true) @ lidar.mount
        first = sensor.yaw + angle_min
        exact = self._caster.sweep(sensor.x, sensor.y, first, angle_increment, beams, lidar.range_max)
        self._scans += 1
        ranges = self._ranges_noise.apply(exact, self._scans)
        ranges[ranges > lidar.range_max] = np.inf
        return ranges

    def probe(self, mount: Pose2D, directions: FloatArray, range_max: float) -> FloatArray:
        """Return how far rays from a point on the base reach now, without noise; may be called by any thread.

        Args:
            mount: Where they start, in the base's frame.
            directions: (n,) of the rays, relative to the mount's [rad].
            range_max: [m]

        Returns:
            (n,) distances to the nearest obstacle [m]; inf where there is none within ``range_max``.
        """
        sensor = Pose2D(*self.motion.true) @ mount
        ranges = self._caster.cast(sensor.x, sensor.y, sensor.yaw + directions, range_max)
        ranges[ranges > range_max] = np.inf
        return ranges

    def frame(self) -> SimFrame:
        """Return what the camera sees now; rendered when its pixels are first asked for."""
        motion, stamp = self.motion, self.now
        pan, tilt = self.joints(stamp)
        return self._camera.capture(Pose2D(*motion.true), pan, tilt, stamp, Pose2D(*motion.odometry))

    def step(self) -> None:
        """Let 20 ms pass at once: the controllers work, the base moves. Not while it runs by itself."""
        for controller in self.controllers:
            controller(self.now)
        self._physics.advance_to((self._physics.step + 1) / STEPS_PER_SECOND)

    def start(self) -> None:
        """Let time pass. The first step is done at once, with the compiling that it may need."""
        self.probe(self.spec.lidar.mount, np.zeros(1), self.spec.lidar.range_max)
        self.step()
        self._running.set()
        self._thread.start()

    def close(self) -> None:
        """Stop time; may be called twice."""
        self._running.clear()
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join()

    def _run(self) -> None:
        zero = time.monotonic() - self.now
        while self._running.is_set():
            due = zero + (self._physics.step + 1) / STEPS_PER_SECOND
            late = time.monotonic() - due
            if late > _LOST:
                zero += late
            time.sleep(max(-late, 0.0))
            self.step()
