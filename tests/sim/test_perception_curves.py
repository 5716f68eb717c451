from __future__ import annotations

import numpy as np
import pytest

from sim.perception import DetectorSettings, MatcherSettings
from sim.perception.curves import chance_given, crop_quality, detection_chance, name_fit

SETTINGS = DetectorSettings()


@pytest.mark.parametrize(("size", "chance"), [(100, 0.9), (40, 0.8), (20, 0.55), (10, 0.22), (4.9, 0.0)])
def test_the_chance_of_detection_has_the_published_course(size, chance):
    found = detection_chance(np.array([size]), np.array([size]), np.array([1.0]), False, SETTINGS)
    assert found[0] == pytest.approx(chance, abs=0.02)


def test_the_chance_of_detection_grows_with_size_short_side_and_visible_fraction():
    steps = np.linspace(0, 1, 60)
    one = np.ones(60)
    for arguments in ((3 + 200 * steps, 50 * one, one), (40 * one, 8 * steps, one), (40 * one, 40 * one, steps)):
        assert (np.diff(detection_chance(*arguments, False, SETTINGS)) >= -1e-12).all()


def test_harder_instances_are_found_less_often():
    easy, hard = (
        chance_given(np.array([20.0]), np.array([20.0]), np.array([1.0]), False, d, SETTINGS)[0] for d in (-1, 1)
    )
    assert easy > hard > 0


def test_cut_off_furniture_is_still_recognised():
    arguments = np.array([200.0]), np.array([150.0]), np.array([0.25])
    assert detection_chance(*arguments, True, SETTINGS) > 2 * detection_chance(*arguments, False, SETTINGS)


def test_a_name_fits_itself_and_a_stranger_not_at_all():
    fits = name_fit(np.array([-0.3, 0.0, 0.2, 0.5, 1.0]), MatcherSettings())
    assert fits[0] == fits[1] == 0.0
    assert fits[2] == pytest.approx(0.5, abs=0.03)
    assert fits[3] > 0.85
    assert fits[4] == pytest.approx(1.0)


def test_crops_are_better_the_larger_the_freer_and_the_better_placed():
    def quality(size, fraction, overlap):
        return float(crop_quality(np.array(size), np.array(fraction), np.array(overlap), MatcherSettings()))

    assert quality(100, 1.0, 1.0) == pytest.approx(1.0, abs=1e-3)
    assert quality(100, 1.0, 1.0) > quality(10, 1.0, 1.0)
    assert quality(100, 1.0, 1.0) > quality(100, 0.3, 1.0)
    assert quality(100, 1.0, 1.0) > quality(100, 1.0, 0.5)
