"""Which LiDAR of the market measures as a robot's LiDAR does: its steps, ranges and speed."""

from __future__ import annotations

import math

from drivers.lidar.codec import Parameters
from zavis_bt.types import LidarSpec

_MODEL = "UST-10LX"
_FINEST = 4  # steps to a beam
_SLACK = 1e-6
_LAST_STEP = 9999  # requests have four characters for a step


def model_of(spec: LidarSpec) -> Parameters:
    """Return the parameters of a sensor that sweeps the spec's field of view.

    Steps are as far apart as the spec's beams where a full turn is a whole number of them and one of them looks
    straight ahead; else a half, a third or a quarter of that, whatever suits, and about a half of it
    if nothing does.
    """
    per_beam = next((n for n in range(1, _FINEST + 1) if _suits(spec, n)), 2)
    ares = round(math.tau / spec.angle_increment * per_beam)
    whole_turn = spec.field_of_view >= math.tau - 1e-9
    half = min(math.floor(spec.field_of_view / 2 / (math.tau / ares) + _SLACK), _LAST_STEP // 2)
    return Parameters(
        model=_MODEL,
        dmin=round(spec.range_min * 1000),
        dmax=round(spec.range_max * 1000),
        ares=ares,
        amin=0,
        amax=min(2 * half, ares - 1) if whole_turn else 2 * half,
        afrt=half,
        scan=round(spec.rate * 60),
    )


def _suits(spec: LidarSpec, per_beam: int) -> bool:
    """Return whether such parts of a beam divide the turn, and the way from the first beam to straight ahead."""
    step = spec.angle_increment / per_beam
    return all(abs(ratio - round(ratio)) < _SLACK * ratio for ratio in (math.tau / step, spec.field_of_view / 2 / step))
