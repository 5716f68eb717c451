"""Settings of a CANopen pan-tilt unit in a robot file."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from drivers.settings import Settings

Node = Annotated[int, Field(ge=1, le=127)]
Seconds = Annotated[float, Field(gt=0, le=120, allow_inf_nan=False)]
Degrees = Annotated[float, Field(allow_inf_nan=False)]


class HomingSettings(Settings):
    """How the drives find their zero when the unit is opened."""

    method: int = Field(default=37, ge=-128, le=127)
    """6098: 37 or 35 take the present position, 17 and 18 search the negative or positive limit switch, …."""
    pan_offset_deg: Degrees = 0.0
    """Pan angle of the home position."""
    tilt_offset_deg: Degrees = 0.0
    speed_deg: float = Field(default=20.0, gt=0, le=360)
    """Of the search for the switch; a tenth of it for leaving the switch."""
    timeout: Seconds = 60.0


class PanTiltSettings(Settings):
    """What a robot file says of the unit; angles under names with ``_deg`` are in degrees."""

    interface: str = "socketcan"
    """Kind of bus, as python-can calls it: ``socketcan``, ``slcan``, ``pcan``, ``udp_multicast``, ``virtual``, …."""
    channel: str | int = "can0"
    bitrate: int = Field(default=500_000, ge=10_000, le=1_000_000)
    """Where python-can sets it; a SocketCAN interface has it set by ``ip link``."""
    options: dict[str, Any] = Field(default_factory=dict)
    """Further arguments of that kind of bus."""
    pan_node: Node = 1
    tilt_node: Node = 2
    master_node: Node = 127
    """Number under which this computer's heartbeat is sent."""
    units_per_degree: float | None = Field(default=None, gt=0, allow_inf_nan=False)
    """The drives' unit of angles; 1000 if neither this nor ``units_per_radian`` is given."""
    units_per_radian: float | None = Field(default=None, gt=0, allow_inf_nan=False)
    pan_inverted: bool = False
    """Whether the drive counts clockwise."""
    tilt_inverted: bool = False
    """Whether the drive counts downwards."""
    mode: Literal["cyclic", "profile"] = "cyclic"
    """``cyclic``: jerk-limited set-points every cycle; ``profile``: the drives make their own profiles."""
    rate: float = Field(default=50.0, ge=10, le=200)
    """Cycles a second [Hz]."""
    max_jerk_deg: float | None = Field(default=None, gt=0, allow_inf_nan=False)
    """[deg/s³]; such that the greatest acceleration is reached in 0.1 s if not given."""
    tolerance_deg: float = Field(default=0.3, gt=0, le=10)
    """How near to the target both axes must be to count as settled."""
    homing: HomingSettings | None = None
    """None if the drives know their zero."""
    heartbeat: Seconds = 0.1
    """Time between two heartbeats, of the drives and of this computer [s]."""
    heartbeat_timeout: Seconds = 0.5
    """Silence after which a drive counts as lost, and after which a drive stops by itself [s]."""
    answer_timeout: Seconds = 0.25
    """Time without measurements after which a drive counts as lost [s]."""
    sdo_timeout: Seconds = 0.5
    """[s]"""

    @model_validator(mode="after")
    def _consistent(self) -> PanTiltSettings:
        if len({self.pan_node, self.tilt_node, self.master_node}) < 3:
            raise ValueError("pan_node, tilt_node and master_node must differ")
        if None not in (self.units_per_degree, self.units_per_radian):
            raise ValueError("give either 'units_per_degree' or 'units_per_radian'")
        if self.heartbeat_timeout < 2 * self.heartbeat:
            raise ValueError("heartbeat_timeout must be at least twice the heartbeat")
        return self

    @property
    def units(self) -> float:
        """The drives' units in a radian."""
        if self.units_per_radian is not None:
            return self.units_per_radian
        return math.degrees(self.units_per_degree or 1000.0)

    @property
    def period(self) -> float:
        """Time of a cycle, whole milliseconds [s]."""
        return round(1000 / self.rate) / 1000
