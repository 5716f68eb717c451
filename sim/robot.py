"""The simulated robot: its devices and its model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sim.base import SimBase
from sim.lidar import SimLidar
from sim.pan_tilt import SimPanTilt
from sim.physics import STEPS_PER_SECOND, Physics, Schedule
from zavis_bt.types import RobotSpec

if TYPE_CHECKING:
    from sim.camera import SimCamera
    from sim.frame import SimFrame


class MountedCamera:
    """The camera on the robot's pan-tilt unit, taking frames at its rate."""

    def __init__(self, camera: SimCamera, physics: Physics, pan_tilt: SimPanTilt, rate: float) -> None:
        self._camera, self._physics, self._pan_tilt = camera, physics, pan_tilt
        self._schedule = Schedule(rate)
        self._last: tuple[int, SimFrame] | None = None

    def frame(self) -> SimFrame:
        """Return the latest frame, taken from where base and unit were at its stamp; the same object until the next."""
        number, step = self._schedule.latest(self._physics.step)
        if self._last is None or self._last[0] != number:
            stamp = step / STEPS_PER_SECOND
            pan, tilt = self._pan_tilt.angles_at(stamp)
            true, odometry = self._physics.poses_at(step)
            self._last = number, self._camera.capture(true, pan, tilt, stamp, odometry)
        return self._last[1]


@dataclass(frozen=True, slots=True)
class SimRobot:
    """All devices of a simulated robot."""

    spec: RobotSpec
    base: SimBase
    pan_tilt: SimPanTilt
    lidar: SimLidar
    camera: MountedCamera

    def close(self) -> None:
        """Stop all motion."""
        self.base.stop()
        self.pan_tilt.stop()
