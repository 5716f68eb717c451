"""What kinds of Pioneer there are: name plates, limits, conversion factors, sonar."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from drivers.pioneer.codec import Config
from zavis_bt.types import FloatArray

Mount = tuple[int, int, int]
"""x, y [mm] and direction [degree] in the base's frame."""

_P3AT_SONAR: tuple[Mount, ...] = (
    *((147, 136, 90), (193, 119, 50), (227, 79, 30), (245, 27, 10)),
    *((245, -27, -10), (227, -79, -30), (193, -119, -50), (147, -136, -90)),
    *((-144, -136, -90), (-189, -119, -130), (-223, -79, -150), (-241, -27, -170)),
    *((-241, 27, 170), (-223, 79, 150), (-189, 119, 130), (-144, 136, 90)),
)
_P3DX_SONAR: tuple[Mount, ...] = (
    *((69, 136, 90), (114, 119, 50), (148, 78, 30), (166, 27, 10)),
    *((166, -27, -10), (148, -78, -30), (114, -119, -50), (69, -136, -90)),
    *((-157, -136, -90), (-203, -119, -130), (-237, -78, -150), (-255, -27, -170)),
    *((-255, 27, 170), (-237, 78, 150), (-203, 119, 130), (-157, 136, 90)),
)


@dataclass(frozen=True, slots=True)
class PioneerModel:
    """One kind of Pioneer. Its stored configuration is the state after each start."""

    config: Config
    diff_conv_factor: float
    """Rotation for half the difference of the wheel speeds [rad/s per mm/s]."""
    distance_factor: float = 1.0
    """Distance of a unit of position [mm]."""
    sonar: tuple[Mount, ...] = _P3AT_SONAR
    """Transducers, by number: eight for each array."""
    sonar_range: int = 5000
    """What a transducer says without an echo [mm]."""
    vel2_unit: int = 20
    """Wheel speed of a unit of VEL2 [mm/s]."""
    battery_empty: float = 11.0
    """Voltage without charge [V]."""
    battery_full: float = 13.0
    """Voltage when full [V]."""

    @property
    def period(self) -> float:
        """Time from one information packet to the next [s]."""
        return self.config.sip_cycle / 1000

    @property
    def transducers(self) -> FloatArray:
        """(n, 3) poses of the sonar transducers in the base's frame [m, m, rad]."""
        return np.array(self.sonar, dtype=np.float64) * (0.001, 0.001, math.pi / 180)


P3AT = PioneerModel(
    Config(subclass="p3at-sh", serial_number="SIM-3AT", name="simrobot", front_bumpers=5, rear_bumpers=5),
    diff_conv_factor=0.0034,
)
"""Pioneer 3-AT with both sonar arrays and bumpers."""

P3DX = PioneerModel(
    replace(
        P3AT.config,
        subclass="p3dx-sh",
        serial_number="SIM-3DX",
        velocity_top=2200,
        rotation_velocity_top=500,
        rev_count=16570,
        ticks_per_mm=128,
    ),
    diff_conv_factor=0.0056,
    sonar=_P3DX_SONAR,
)
"""Pioneer 3-DX with both sonar arrays and bumpers."""
