"""The robot of a robot file: its devices, opened through their drivers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.metadata import EntryPoint, entry_points
from typing import Any, cast

from zavis_bt.errors import DeviceError, InputError, did_you_mean
from zavis_bt.geometry import transform_camera_to_map
from zavis_bt.mission.robot_file import DeviceSetting, RobotFile
from zavis_bt.protocols import Base, Camera, Clock, Device, DeviceContext, DeviceFactory, Lidar, PanTilt
from zavis_bt.types import FloatArray, Pose2D, RobotSpec

GROUP = "zavis_bt.devices"
"""Entry point group of the drivers, named ``<kind>.<driver>``, for example ``base.pioneer``."""
KINDS = ("base", "pan_tilt", "lidar", "camera")
"""The devices of a robot, in the order they are opened."""
_POLL = 0.02  # [s]


class DeviceRobot:
    """A robot whose devices are played by drivers."""

    def __init__(
        self,
        file: RobotFile,
        clock: Clock,
        start: Pose2D | None = None,
        *,
        kinds: Iterable[str] = KINDS,
        opening: Callable[[str], object] = str,
    ) -> None:
        """Open the devices; if one fails, those opened before are closed again.

        Args:
            file: The robot.
            clock: Of the mission; all stamps are on it.
            start: Where the robot stands in the map; the origin if not given.
            kinds: Which devices; without the others, the camera's pose is the one it has when they are at rest.
            opening: Told the kind of each device before it is opened.

        Raises:
            InputError: A device or a driver is missing, or a setting is wrong.
            DeviceError: A device cannot be opened.
        """
        self._file, self._clock, self._start = file, clock, start or Pose2D(0.0, 0.0)
        self.devices: dict[str, Device] = {}
        """By kind, in the order opened."""
        factories = {kind: find_driver(file, kind) for kind in kinds}
        try:
            for kind, factory in factories.items():
                opening(kind)
                self.devices[kind] = factory(file.devices[kind].settings, self._context(kind))
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
        """The camera on the pan-tilt unit."""
        return cast(Camera, self._device("camera"))

    def wait_until_ready(self, timeout: float = 5.0) -> None:
        """Wait until every device has delivered something.

        Args:
            timeout: How long at most [s].

        Raises:
            DeviceError: A device says nothing for that long, or cannot work.
        """
        deadline = self._clock.now() + timeout
        while missing := self._missing():
            if self._clock.now() > deadline:
                kind, what = missing
                place = f"{self._file.path}: devices.{kind}"
                raise DeviceError(f"{place}: {what} for {timeout:g} s ('zavis doctor' tells more)")
            self._clock.wait_until(self._clock.now() + _POLL)

    def _missing(self) -> tuple[str, str] | None:
        """Return the first device that is not ready, and what is amiss."""
        for kind, state in (("base", self.base.state()), ("pan_tilt", self.pan_tilt.state())):
            if state.fault:
                return kind, state.fault
        if self.lidar.scan() is None:
            return "lidar", "no scan"
        return ("camera", "no frame") if self.camera.frame() is None else None

    def close(self) -> None:
        """Stop all motion, the base first, and release the devices."""
        for device in self.devices.values():
            device.close()

    def _context(self, kind: str) -> DeviceContext:
        where = f"{self._file.path}: devices.{kind}"
        return DeviceContext(where, self._file.spec, self._clock, self._start, self._camera_pose)

    def _device(self, kind: str) -> Device:
        if kind not in self.devices:
            raise DeviceError(f"{self._file.path}: devices.{kind}: is not open")
        return self.devices[kind]

    def _camera_pose(self, stamp: float) -> FloatArray:
        base = self.base.pose_at(stamp) if "base" in self.devices else self._start
        pan, tilt = self.pan_tilt.angles_at(stamp) if "pan_tilt" in self.devices else (0.0, 0.0)
        return transform_camera_to_map(base, pan, tilt, self._file.spec.camera)


def open_device(file: RobotFile, kind: str, clock: Clock) -> Device:
    """Open one device of a robot alone, as a check of it does.

    Raises:
        InputError: The device or its driver is missing, or a setting is wrong.
        DeviceError: It cannot be opened.
    """
    return DeviceRobot(file, clock, kinds=(kind,)).devices[kind]


def find_driver(file: RobotFile, kind: str) -> DeviceFactory:
    """Return the function that opens a device of this kind.

    Raises:
        InputError: The file names no such device, there is no such driver, or it cannot be loaded.
    """
    setting = file.devices.get(kind)
    if setting is None:
        raise InputError(f"{file.path}: devices.{kind}: is missing (name its driver, or remove 'devices')")
    found = _drivers(kind)
    if setting.driver not in found:
        hint = did_you_mean(setting.driver, found)
        raise InputError(f"{file.path}: devices.{kind}.driver: no driver '{setting.driver}' for a {kind}{hint}")
    return _load(found[setting.driver], file, kind, setting)


def _drivers(kind: str) -> Mapping[str, EntryPoint]:
    prefix = f"{kind}."
    entries = entry_points(group=GROUP)
    return {entry.name.removeprefix(prefix): entry for entry in entries if entry.name.startswith(prefix)}


def _load(entry: EntryPoint, file: RobotFile, kind: str, setting: DeviceSetting) -> DeviceFactory:
    try:
        factory: Any = entry.load()
    except (ImportError, AttributeError) as error:
        raise InputError(f"{file.path}: devices.{kind}.driver: '{setting.driver}' cannot be loaded: {error}") from error
    return cast(DeviceFactory, factory)
