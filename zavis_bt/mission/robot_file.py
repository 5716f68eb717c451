"""Robot files: ``format: zavis-robot/1``, the robot's model, the devices that play it, and its safety limits.

Lengths are in metres, angles in degrees under names that end in ``_deg``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from zavis_bt.documents import check, read_document
from zavis_bt.errors import InputError
from zavis_bt.mission.safety import SafetySettings
from zavis_bt.types import (
    BaseLimits,
    CameraIntrinsics,
    CameraSpec,
    Footprint,
    LidarSpec,
    PanTiltSpec,
    Pose2D,
    RobotSpec,
)

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Angle = Annotated[float, Field(allow_inf_nan=False), AfterValidator(math.radians)]
PositiveAngle = Annotated[float, Field(gt=0, allow_inf_nan=False), AfterValidator(math.radians)]
Text = Annotated[str, Field(min_length=1)]
Timeout = Annotated[float, Field(ge=0.05, le=60)]
DeviceName = Literal["base", "pan_tilt", "lidar", "camera"]

_SAFETY = SafetySettings()


@dataclass(frozen=True, slots=True)
class DeviceSetting:
    """Which driver plays a device, and the driver's own settings."""

    driver: str
    settings: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RobotFile:
    """Content of a robot file."""

    spec: RobotSpec
    devices: Mapping[str, DeviceSetting]
    """By device: ``base``, ``pan_tilt``, ``lidar``, ``camera``; empty for a robot that only the simulator plays."""
    path: Path
    safety: SafetySettings = field(default_factory=SafetySettings)
    """When motion is limited or refused."""


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


_EntryT = TypeVar("_EntryT", bound=_Entry)


class _Footprint(_Entry):
    radius: Positive | None = None
    length: Positive | None = None
    width: Positive | None = None
    centre_x: Number = 0.0

    @model_validator(mode="after")
    def _disc_or_rectangle(self) -> _Footprint:
        sides = (self.length, self.width)
        if (self.radius is None) == (None in sides) or (self.radius is not None and sides != (None, None)):
            raise ValueError("give either 'radius', or 'length' and 'width'")
        if self.length is not None and abs(self.centre_x) >= self.length / 2:
            raise ValueError(f"centre_x {self.centre_x:g} puts the origin outside of the rectangle")
        if self.radius is not None and self.centre_x != 0:
            raise ValueError("a disc has its origin in its middle (remove 'centre_x')")
        return self

    def value(self) -> Footprint:
        if self.radius is not None:
            return Footprint(2 * self.radius, 2 * self.radius, disc=True)
        assert self.length is not None
        assert self.width is not None
        return Footprint(self.length, self.width, self.centre_x)


class _Limits(_Entry):
    max_linear: Positive
    max_reverse: Positive
    max_angular_deg: PositiveAngle
    linear_acceleration: Positive
    angular_acceleration_deg: PositiveAngle

    def value(self) -> BaseLimits:
        return BaseLimits(
            self.max_linear,
            self.max_reverse,
            self.max_angular_deg,
            self.linear_acceleration,
            self.angular_acceleration_deg,
        )


class _Lidar(_Entry):
    beams: Annotated[int, Field(ge=2, le=100_000)]
    field_of_view_deg: Annotated[float, Field(gt=0, le=360), AfterValidator(math.radians)]
    range_min: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    range_max: Positive
    rate: Annotated[float, Field(gt=0, le=50)]
    x: Number = 0.0
    y: Number = 0.0
    yaw_deg: Angle = 0.0
    height: Positive

    @model_validator(mode="after")
    def _ordered(self) -> _Lidar:
        return _check_order(self, ("range_min", "range_max"))

    def value(self) -> LidarSpec:
        mount = Pose2D(self.x, self.y, self.yaw_deg)
        return LidarSpec(
            self.beams, self.field_of_view_deg, self.range_min, self.range_max, self.rate, mount, self.height
        )


class _PanTilt(_Entry):
    pan_min_deg: Angle
    pan_max_deg: Angle
    tilt_min_deg: Angle
    tilt_max_deg: Angle
    max_rate_deg: PositiveAngle
    max_acceleration_deg: PositiveAngle

    @model_validator(mode="after")
    def _ordered(self) -> _PanTilt:
        return _check_order(self, ("pan_min_deg", "pan_max_deg"), ("tilt_min_deg", "tilt_max_deg"))

    def value(self) -> PanTiltSpec:
        return PanTiltSpec(
            self.pan_min_deg,
            self.pan_max_deg,
            self.tilt_min_deg,
            self.tilt_max_deg,
            self.max_rate_deg,
            self.max_acceleration_deg,
        )


class _Camera(_Entry):
    image: tuple[Annotated[int, Field(ge=16, le=8192)], Annotated[int, Field(ge=16, le=8192)]]
    horizontal_fov_deg: Annotated[float, Field(gt=0, lt=180), AfterValidator(math.radians)]
    x: Number = 0.0
    height: Positive
    depth_min: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    depth_max: Positive
    rate: Annotated[float, Field(gt=0, le=50)]

    @model_validator(mode="after")
    def _ordered(self) -> _Camera:
        return _check_order(self, ("depth_min", "depth_max"))

    def value(self) -> CameraSpec:
        intrinsics = CameraIntrinsics.from_fov(*self.image, self.horizontal_fov_deg)
        return CameraSpec(intrinsics, self.x, self.height, self.depth_min, self.depth_max, self.rate)


class _Device(_Entry):
    driver: Text
    settings: dict[str, Any] = {}


class _Safety(_Entry):
    margin: Annotated[float, Field(ge=0, le=1)] = _SAFETY.margin
    tolerance: Annotated[float, Field(ge=0, le=0.1)] = _SAFETY.tolerance
    deceleration: Positive | None = None
    turn_deceleration_deg: PositiveAngle | None = None
    creep: Positive = _SAFETY.creep
    min_battery: Annotated[float, Field(ge=0, lt=1)] = _SAFETY.min_battery
    base_timeout: Timeout = _SAFETY.base_timeout
    scan_timeout: Timeout = _SAFETY.scan_timeout
    pan_tilt_timeout: Timeout = _SAFETY.pan_tilt_timeout
    frame_timeout: Timeout = _SAFETY.frame_timeout
    tick_limit: Timeout = _SAFETY.tick_limit
    device_timeout: Annotated[float, Field(ge=1, le=3600)] = _SAFETY.device_timeout

    def value(self) -> SafetySettings:
        fields = self.model_dump()
        return SafetySettings(turn_deceleration=fields.pop("turn_deceleration_deg"), **fields)


class _RobotModel(_Entry):
    format: Literal["zavis-robot/1"]
    name: Text
    footprint: _Footprint
    limits: _Limits
    lidar: _Lidar
    pan_tilt: _PanTilt
    camera: _Camera
    devices: dict[DeviceName, _Device] = {}
    safety: _Safety = _Safety()

    def value(self) -> RobotSpec:
        return RobotSpec(
            self.name,
            self.footprint.value(),
            self.limits.value(),
            self.lidar.value(),
            self.pan_tilt.value(),
            self.camera.value(),
        )


def load_robot(path: Path | str) -> RobotFile:
    """Read a robot.

    Raises:
        InputError: The file is missing or wrong; the message is one line about the first fault.
    """
    document = read_document(Path(path))
    model, faults = check(document, _RobotModel)
    if model is None:
        raise InputError(faults[0] + (f" [and {len(faults) - 1} more]" if len(faults) > 1 else ""))
    devices = {str(name): DeviceSetting(device.driver, device.settings) for name, device in model.devices.items()}
    return RobotFile(model.value(), devices, document.path, model.safety.value())


def _check_order(entry: _EntryT, *pairs: tuple[str, str]) -> _EntryT:
    for low, high in pairs:
        if getattr(entry, low) >= getattr(entry, high):
            raise ValueError(f"{low} must be below {high}")
    return entry
