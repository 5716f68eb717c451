"""The robot behind the safety layer."""

from __future__ import annotations

import logging
from functools import cached_property

from zavis_bt.mission.safety.base import SafeBase
from zavis_bt.mission.safety.pan_tilt import SafePanTilt
from zavis_bt.mission.safety.settings import SafetySettings
from zavis_bt.protocols import Camera, Journal, Lidar, Robot
from zavis_bt.types import RobotSpec

_LOG = logging.getLogger(__name__)


class SafeRobot:
    """A robot as behaviours get it: the same devices, what moves behind the safety layer."""

    def __init__(self, robot: Robot, settings: SafetySettings, journal: Journal, period: float = 0.1) -> None:
        """Wrap a robot; nothing moves.

        Args:
            robot: The robot.
            settings: Limits.
            journal: Told when and why motion is limited.
            period: Expected time from tick to tick [s].
        """
        self._robot = robot
        self._base = SafeBase(robot, settings, journal, period)

    @property
    def spec(self) -> RobotSpec:
        """The robot's model."""
        return self._robot.spec

    @property
    def base(self) -> SafeBase:
        """The base behind the safety layer."""
        return self._base

    @cached_property
    def pan_tilt(self) -> SafePanTilt:
        """The pan-tilt unit behind the safety layer."""
        return SafePanTilt(self._robot.pan_tilt)

    @property
    def lidar(self) -> Lidar:
        """The LiDAR."""
        return self._robot.lidar

    @property
    def camera(self) -> Camera:
        """The camera."""
        return self._robot.camera

    def halt(self) -> None:
        """Stop everything that moves, as fast as it can, until `resume`; never raises."""
        for hold in (self._base.hold, self.pan_tilt.hold):
            try:
                hold()
            except Exception:  # whatever one device raises, the other one must still be stopped
                _LOG.exception("%s raised", hold)

    def resume(self) -> None:
        """Let motion go on; what the pan-tilt unit was to do before is begun again."""
        self._base.resume()
        self.pan_tilt.resume()

    def close(self) -> None:
        """Stop and release the devices."""
        self._robot.close()
