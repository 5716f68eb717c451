"""The simulated planar LiDAR."""

from __future__ import annotations

import numpy as np

from sim.noise import RangeNoise
from sim.physics import STEPS_PER_SECOND, Physics, Schedule
from sim.raycast import RayCaster
from zavis_bt.types import LaserScan, LidarSpec


class SimLidar:
    """Scans at its rate; a scan that nobody asks for costs nothing."""

    def __init__(self, physics: Physics, caster: RayCaster, spec: LidarSpec, noise: RangeNoise) -> None:
        self._physics, self._caster, self._spec, self._noise = physics, caster, spec, noise
        self._schedule = Schedule(spec.rate)
        self._last: tuple[int, LaserScan] | None = None

    def scan(self) -> LaserScan:
        """Return the latest scan, taken from where the base was at its stamp; the same object until the next."""
        number, step = self._schedule.latest(self._physics.step)
        if self._last is None or self._last[0] != number:
            self._last = number, self._take(number, step)
        return self._last[1]

    def _take(self, number: int, step: int) -> LaserScan:
        spec = self._spec
        sensor = self._physics.poses_at(step)[0] @ spec.mount
        first = sensor.yaw + spec.angle_min
        exact = self._caster.sweep(sensor.x, sensor.y, first, spec.angle_increment, spec.beams, spec.range_max)
        ranges = self._noise.apply(exact, number)
        ranges[ranges > spec.range_max] = np.inf
        ranges[ranges < spec.range_min] = np.nan  # too close to measure
        ranges.setflags(write=False)
        stamp = step / STEPS_PER_SECOND
        return LaserScan(ranges, spec.angle_min, spec.angle_increment, spec.range_min, spec.range_max, stamp)
