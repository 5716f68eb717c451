"""Settings of a Pioneer base in the robot file."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from drivers.settings import Settings

Baud = Literal[9600, 19200, 38400, 57600, 115200]


class PioneerSettings(Settings):
    """How to reach the robot and how to drive it; speeds and accelerations are the robot file's ``limits``."""

    port: str = Field(min_length=1)
    """``/dev/ttyUSB0``, or ``tcp://host:8101`` for a simulator or an Ethernet bridge."""
    baud: Baud = 9600
    """Speed of the serial port at which the robot is tried first; it starts at 9600."""
    fast_baud: Baud | None = 38400
    """Speed to go on with where robot and port can; None to stay."""
    subclass: str | None = None
    """Takes the robot for this one whatever it says of itself, for example ``p3at-sh``."""
    deceleration: float | None = Field(default=None, gt=0, le=10)
    """Of normal braking [m/s²]; the limits' acceleration if not given."""
    sonar: bool = True
    """Whether the sonar is on: it can be heard, and nothing but `PioneerBase.sonar` reads it."""
    rate: float = Field(default=20.0, ge=5, le=50)
    """How often the velocity is sent while the base moves [Hz]."""
    command_timeout: float = Field(default=0.5, ge=0.1, le=5)
    """The base stops if no command came for so long [s]."""
    silence: float = Field(default=0.5, ge=0.3, le=10)
    """The link counts as lost if no packet came for so long [s]."""
