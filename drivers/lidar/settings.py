"""What a robot file can say of a LiDAR."""

from __future__ import annotations

from pydantic import Field

from drivers.settings import Settings


class ScipSettings(Settings):
    """Settings of the driver ``scip``."""

    port: str
    """``tcp://192.168.0.10:10940``, or a serial port such as ``/dev/ttyACM0``."""
    baud: int = Field(default=115200, gt=0)
    """Speed of a serial port; means nothing to TCP and USB."""
    cluster: int = Field(default=1, ge=1, le=99)
    """Neighbouring steps of which the smallest range makes one beam."""
    skip: int = Field(default=0, ge=0, le=9)
    """Scans that the sensor leaves out after each one it sends."""
    flipped: bool = False
    """Whether the sensor hangs upside down."""
    high_sensitivity: bool = False
    """Whether to use the sensor's mode for dark surfaces, if it has one."""
    time_offset: float = Field(default=0.0, ge=-1.0, le=1.0)
    """Added to the stamps of scans [s]."""
