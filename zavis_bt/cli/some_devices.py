"""A robot of which only some devices are open: to check or drive one that is not complete yet."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import cast

from zavis_bt.errors import DeviceError
from zavis_bt.mission.device_robot import open_device
from zavis_bt.mission.robot_file import RobotFile
from zavis_bt.protocols import Base, Camera, Clock, Device, Lidar, PanTilt
from zavis_bt.types import RobotSpec


class SomeDevices:
    """A robot with the devices that are named; it is an error to ask for another one."""

    def __init__(
        self, file: RobotFile, kinds: Iterable[str], clock: Clock, opening: Callable[[str], object] = str
    ) -> None:
        """Open devices; if one fails, those opened before are closed again.

        Args:
            file: The robot.
            kinds: Names of its devices.
            clock: That all stamps are on.
            opening: Told the name of each device before it is opened.

        Raises:
            InputError: A device or a driver is missing, or a setting is wrong.
            DeviceError: A device cannot be opened.
        """
        self._file = file
        self._devices: dict[str, Device] = {}
        try:
            for kind in kinds:
                opening(kind)
                self._devices[kind] = open_device(file, kind, clock)
        except BaseException:
            self.close()
            raise

    @property
    def spec(self) -> RobotSpec:
        """Footprint, limits, mounts."""
        return self._file.spec

    @property
    def base(self) -> Base:
        """The mobile base."""
        return cast(Base, self._device("base"))

    @property
    def pan_tilt(self) -> PanTilt:
        """The pan-tilt unit."""
        return cast(PanTilt, self._device("pan_tilt"))

    @property
    def lidar(self) -> Lidar:
        """The LiDAR."""
        return cast(Lidar, self._device("lidar"))

    @property
    def camera(self) -> Camera:
        """The camera."""
        return cast(Camera, self._device("camera"))

    def __contains__(self, kind: str) -> bool:
        return kind in self._devices

    def close(self) -> None:
        """Stop all motion and release the devices; may be called twice."""
        for device in self._devices.values():
            device.close()

    def _device(self, kind: str) -> Device:
        if kind not in self._devices:
            raise DeviceError(f"{self._file.path}: devices.{kind}: is not open")
        return self._devices[kind]
