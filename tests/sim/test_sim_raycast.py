from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.raycast import RayCaster


def slab_distances(occupied: np.ndarray, x: float, y: float, angles: np.ndarray, margin: float) -> np.ndarray:
    """Distance along each ray to the nearest occupied square of side 1, grown by a margin, by the slab method."""
    rows, cols = np.nonzero(occupied)
    low = np.stack((cols - margin, rows - margin), axis=1)[None]
    high = np.stack((cols + 1 + margin, rows + 1 + margin), axis=1)[None]
    direction = np.stack((np.cos(angles), np.sin(angles)), axis=1)[:, None]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        one, two = (low - (x, y)) / direction, (high - (x, y)) / direction
    enter, leave = np.fmin(one, two).max(axis=2), np.fmax(one, two).min(axis=2)
    return np.where((enter <= leave) & (leave >= 0), np.maximum(enter, 0), np.inf).min(axis=1, initial=np.inf)


@settings(deadline=None, max_examples=150)
@given(
    seed=st.integers(0, 2**32 - 1),
    density=st.sampled_from([0.0, 0.02, 0.1, 0.4]),
    x=st.floats(0.0, 22.9),
    y=st.floats(0.0, 16.9),
    angle=st.one_of(st.floats(-7, 7), st.integers(-8, 8).map(lambda k: k * math.pi / 4)),
)
def test_ranges_equal_those_to_the_squares_of_the_cells(
    seed: int, density: float, x: float, y: float, angle: float
) -> None:
    occupied = np.random.default_rng(seed).random((17, 23)) < density
    angles = angle + np.arange(16) * 0.3937
    ranges = RayCaster(occupied, 1.0, (0.0, 0.0)).cast(x, y, angles, 100.0)
    # A ray that grazes a corner may be seen either way: between squares a bit too large and a bit too small.
    nearest, farthest = (slab_distances(occupied, x, y, angles, margin) for margin in (1e-9, -1e-9))
    assert (ranges >= nearest - 1e-6).all()
    assert (ranges <= farthest + 1e-6).all()


def test_resolution_and_origin_scale_and_shift() -> None:
    occupied = np.random.default_rng(3).random((30, 40)) < 0.05
    angles = np.linspace(-3, 3, 50)
    plain = RayCaster(occupied, 1.0, (0.0, 0.0)).cast(12.3, 7.7, angles, 100.0)
    moved = RayCaster(occupied, 0.05, (-1.0, 2.0)).cast(-1 + 12.3 * 0.05, 2 + 7.7 * 0.05, angles, 5.0)
    np.testing.assert_allclose(moved, plain * 0.05, atol=1e-9)


def test_a_long_free_way_is_leapt_and_still_exact() -> None:
    occupied = np.zeros((3, 3000), dtype=np.bool_)
    occupied[:, -1] = True
    caster = RayCaster(occupied, 0.05, (0.0, 0.0))
    assert caster.cast(0.01, 0.075, np.array([0.0]), 1000.0)[0] == pytest.approx(2999 * 0.05 - 0.01, abs=1e-9)


def test_no_return_is_infinite() -> None:
    occupied = np.zeros((20, 20), dtype=np.bool_)
    occupied[:, 15] = True
    caster = RayCaster(occupied, 1.0, (0.0, 0.0))
    assert caster.cast(5.0, 5.5, np.array([0.0, math.pi]), 9.0).tolist() == [math.inf, math.inf]
    assert caster.cast(5.0, 5.5, np.array([0.0]), 10.0).tolist() == [10.0]
    assert caster.cast(-3.0, 5.5, np.array([0.0]), 100.0).tolist() == [math.inf]


def test_a_ray_from_inside_an_obstacle_has_length_zero() -> None:
    assert (
        RayCaster(np.ones((4, 4), dtype=np.bool_), 1.0, (0.0, 0.0)).cast(1.5, 1.5, np.zeros(3), 5.0).tolist() == [0] * 3
    )


def test_a_sweep_is_a_cast_of_evenly_spaced_rays() -> None:
    caster = RayCaster(np.random.default_rng(1).random((50, 50)) < 0.05, 0.1, (0.0, 0.0))
    swept = caster.sweep(2.0, 2.0, -1.0, 0.05, 40, 5.0)
    np.testing.assert_array_equal(swept, caster.cast(2.0, 2.0, -1.0 + 0.05 * np.arange(40), 5.0))
