"""What the ring of sonar transducers has heard."""

from __future__ import annotations

import math
from typing import NamedTuple

from drivers.pioneer.codec import Sip
from drivers.pioneer.models import Parameters
from zavis_bt.types import Pose2D

_NO_ECHO = 5000  # what a transducer says without one, or more [mm]


class Echo(NamedTuple):
    """The latest reading of one transducer."""

    number: int
    mount: Pose2D
    """Where it sits and looks, in the base's frame."""
    range: float
    """[m]; inf without an echo."""
    stamp: float
    """When it was told [s]."""


def merge(known: tuple[Echo, ...], sip: Sip, stamp: float, parameters: Parameters) -> tuple[Echo, ...]:
    """Return the latest reading of each transducer, by number, after a SIP that arrived at ``stamp`` [s]."""
    if not sip.sonar:
        return known
    latest = {echo.number: echo for echo in known}
    for number, millimetres in sip.sonar:
        mount = parameters.sonar_mount(number)
        if mount is not None:
            distance = millimetres / 1000 if millimetres < _NO_ECHO else math.inf
            latest[number] = Echo(number, mount, distance, stamp)
    return tuple(latest[number] for number in sorted(latest))
