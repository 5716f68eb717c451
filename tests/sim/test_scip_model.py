from __future__ import annotations

import math

import pytest

from sim.devices.scip_model import model_of
from zavis_bt.types import LidarSpec, Pose2D


def spec(beams: int, degrees: float) -> LidarSpec:
    return LidarSpec(beams, math.radians(degrees), 0.02, 30.0, 40.0, Pose2D(0.0, 0.0), 0.3)


@pytest.mark.parametrize(
    ("beams", "degrees", "steps"),
    [
        (1081, 270, (1440, 1080, 540)),
        (181, 180, (360, 180, 90)),
        (360, 360, (360, 359, 180)),
        (721, 180, (1440, 720, 360)),
        (180, 179, (720, 358, 179)),
        (361, 180, (720, 360, 180)),
    ],
)
def test_steps_lie_on_the_beams(beams, degrees, steps):
    model = model_of(spec(beams, degrees))
    assert (model.ares, model.amax, model.afrt) == steps
    assert model.amin == 0


@pytest.mark.parametrize(
    ("beams", "degrees"), [(683, 240.1), (100, 33.3), (2, 7.0), (7, 360), (1000, 123.4), (20001, 180)]
)
def test_any_field_of_view_is_covered_to_within_two_steps_or_ten_thousand(beams, degrees):
    given = spec(beams, degrees)
    model = model_of(given)
    step = math.tau / model.ares
    assert 0 < model.afrt <= model.amax <= 9999
    assert -model.afrt * step >= given.angle_min - 1e-6
    if model.amax < 9990:
        assert -model.afrt * step <= given.angle_min + 2 * step


def test_ranges_and_speed_are_the_robots():
    model = model_of(spec(1081, 270))
    assert (model.dmin, model.dmax, model.scan) == (20, 30000, 2400)
