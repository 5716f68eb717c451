"""Parameters of the Pioneer families: conversion factors, bounds, outline, sonar. The robot's subclass chooses.

The controller of subclasses with ``-sh`` counts in millimetres; older ones count in units of the wheel encoders.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from zavis_bt.types import Pose2D

Mount = tuple[float, float, float]
"""x, y [mm] and direction [degree] in the base's frame."""


@dataclass(frozen=True, slots=True)
class Parameters:
    """What a driver must know of one kind of Pioneer."""

    family: str
    distance_factor: float
    """Millimetres in a unit of XPOS and YPOS (DistConvFactor)."""
    velocity_factor: float
    """mm/s in a unit of the wheels' velocities (VelConvFactor)."""
    difference_factor: float
    """Rotation for half the difference of the wheels' velocities [rad/s per mm/s] (DiffConvFactor)."""
    max_linear: float
    """Absolute bound [m/s]."""
    max_angular: float
    """Absolute bound [rad/s]."""
    max_linear_acceleration: float
    """Absolute bound where the robot tells none [m/s²]."""
    max_angular_acceleration: float
    """[rad/s²]"""
    length: float
    """[m]"""
    width: float
    """[m]"""
    sonar: tuple[Mount, ...]
    """Transducers by their number."""
    known: bool = True
    """Whether the subclass is one of this family, not merely taken as such."""

    @property
    def track(self) -> float:
        """Effective distance between left and right wheels, with their skid [m]."""
        return 0.002 / self.difference_factor

    def sonar_mount(self, number: int) -> Pose2D | None:
        """Return where a transducer sits on the base and looks; None if there is no such one."""
        if not 0 <= number < len(self.sonar):
            return None
        x, y, degrees = self.sonar[number]
        return Pose2D(x / 1000, y / 1000, math.radians(degrees))


_P3AT = Parameters(
    family="p3at",
    distance_factor=1.0,
    velocity_factor=1.0,
    difference_factor=0.0034,
    max_linear=1.2,
    max_angular=math.radians(300),
    max_linear_acceleration=4.0,
    max_angular_acceleration=math.radians(600),
    length=0.626,
    width=0.505,
    sonar=(
        *((147, 136, 90), (193, 119, 50), (227, 79, 30), (245, 27, 10)),
        *((245, -27, -10), (227, -79, -30), (193, -119, -50), (147, -136, -90)),
        *((-144, -136, -90), (-189, -119, -130), (-223, -79, -150), (-241, -27, -170)),
        *((-241, 27, 170), (-223, 79, 150), (-189, 119, 130), (-144, 136, 90)),
    ),
)
_P3DX = Parameters(
    family="p3dx",
    distance_factor=1.0,
    velocity_factor=1.0,
    difference_factor=0.0056,
    max_linear=2.2,
    max_angular=math.radians(500),
    max_linear_acceleration=4.0,
    max_angular_acceleration=math.radians(600),
    length=0.511,
    width=0.425,
    sonar=(
        *((69, 136, 90), (114, 119, 50), (148, 78, 30), (166, 27, 10)),
        *((166, -27, -10), (148, -78, -30), (114, -119, -50), (69, -136, -90)),
        *((-157, -136, -90), (-203, -119, -130), (-237, -78, -150), (-255, -27, -170)),
        *((-255, 27, 170), (-237, 78, 150), (-203, 119, 130), (-157, 136, 90)),
    ),
)
_OLDER_DISTANCE_FACTORS = {"p3at": 0.465, "p3dx": 0.485}
FAMILIES = (_P3AT, _P3DX)


def parameters_of(subclass: str) -> Parameters:
    """Return the parameters of a subclass, compared without case: ``p3at-sh``, ``p3atiw-sh``, ``p3dx-sh-lms1xx``, ….

    One that belongs to no family is taken as a ``p3at-sh``, with ``known`` False.
    """
    name = subclass.lower()
    for family in FAMILIES:
        if name.startswith(family.family):
            if "-sh" in name:
                return family
            return replace(family, distance_factor=_OLDER_DISTANCE_FACTORS[family.family])
    return replace(_P3AT, known=False)


def charge_share(voltage: float) -> float:
    """Return the state of charge of the 12 V lead-acid batteries from their voltage [V], 0 to 1; 1 if there is none.

    11 V is empty, where the robot soon switches itself off, and 13 V full. A real battery is at neither for long, and
    sags under load: it is a coarse measure.
    """
    return min(max((voltage - 11.0) / 2.0, 0.0), 1.0) if voltage > 0 else 1.0
