from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mapping_rooms import CELL, LEGS, ORIGIN, grown, places, room, scan_at, states_like

from sim.raycast import RayCaster
from zavis_bt.errors import InputError
from zavis_bt.mapping import OccupancyGrid, SensorModel
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, GridMap, LaserScan, Pose2D


def scan_of(ranges: list[float], fov: float = math.pi, range_max: float = 8.0) -> LaserScan:
    return LaserScan(np.array(ranges), -fov / 2, fov / max(len(ranges) - 1, 1), 0.02, range_max, 0.0)


@pytest.fixture(scope="module")
def walls() -> np.ndarray:
    return room()


@pytest.fixture(scope="module")
def caster(walls: np.ndarray) -> RayCaster:
    return RayCaster(walls, CELL, ORIGIN)


@pytest.mark.parametrize("beams", [91, 181, 721])
def test_many_scans_give_the_true_room(walls: np.ndarray, caster: RayCaster, beams: int) -> None:
    grid = OccupancyGrid(CELL)
    for pose in places(walls, 150):
        grid.integrate(scan_at(caster, pose, beams), pose)
    states = states_like(grid.map, walls)
    faces = walls & grown(~walls)
    assert (states[~walls] == FREE).mean() > 0.998
    assert (states[faces] == OCCUPIED).mean() > 0.998
    assert not (states[walls] == FREE).any()
    assert not ((states == OCCUPIED) & ~grown(walls)).any()


def test_legs_of_one_cell_survive_beams_that_pass_beside_them(walls: np.ndarray, caster: RayCaster) -> None:
    grid = OccupancyGrid(CELL)
    for pose in places(walls, 300, seed=1):
        grid.integrate(scan_at(caster, pose, beams=61), pose)
    states = states_like(grid.map, walls)
    assert [states[leg] for leg in LEGS] == [OCCUPIED] * len(LEGS)


def test_a_noisy_wall_does_not_grow_thick(walls: np.ndarray, caster: RayCaster) -> None:
    rng, grid = np.random.default_rng(3), OccupancyGrid(CELL)
    for pose in places(walls, 200, seed=2):
        exact = scan_at(caster, pose)
        noisy = exact.ranges + rng.normal(0.0, 0.01, len(exact.ranges))
        grid.integrate(LaserScan(noisy, exact.angle_min, exact.angle_increment, 0.02, 30.0, 0.0), pose)
    states = states_like(grid.map, walls)
    faces = walls & grown(~walls)
    assert (states[faces] == OCCUPIED).mean() > 0.99
    assert ((states == OCCUPIED) & ~walls).sum() < 0.1 * faces.sum()


BEAM = st.floats(0.1, 8.0) | st.just(math.inf) | st.just(math.nan)
RANGES = st.lists(BEAM, min_size=40, max_size=200)
FIELD_OF_VIEW = st.floats(0.2, 6.0)


@settings(max_examples=60, deadline=None)
@given(ranges=RANGES, fov=FIELD_OF_VIEW, yaw=st.floats(-4.0, 4.0))
def test_a_scan_says_nothing_of_what_is_behind_its_hits(ranges: list[float], fov: float, yaw: float) -> None:
    grid, scan = OccupancyGrid(CELL), scan_of(ranges, fov)
    grid.integrate(scan, Pose2D(0.3, -0.2, yaw))
    offsets = grid.map.to_points(np.argwhere(grid.map.states != UNKNOWN)) - (0.3, -0.2)
    distances, bearings = np.hypot(*offsets.T), np.arctan2(offsets[:, 1], offsets[:, 0]) - yaw
    reach = np.nan_to_num(scan.ranges, nan=0.0, posinf=8.0)
    # A cell may have been seen by any beam that comes within a cell of it, and by the pair it lies between.
    turns = np.remainder(bearings[:, None] - scan.angles + math.pi, math.tau) - math.pi
    beside = np.abs(turns) <= scan.angle_increment + np.arcsin(np.minimum(CELL / distances, 1))[:, None]
    seen = (beside & (distances[:, None] <= reach + 2 * CELL)).any(axis=1)
    assert (seen | (distances < 2 * CELL)).all()


@settings(max_examples=60, deadline=None)
@given(ranges=RANGES, fov=FIELD_OF_VIEW)
def test_a_scan_changes_no_cell_by_more_than_one_reading(ranges: list[float], fov: float) -> None:
    model = SensorModel()
    grid = OccupancyGrid(CELL, model=model._replace(low=-50.0, high=50.0))
    grid.integrate(scan_of(ranges, fov), Pose2D(0.01, 0.02, 0.3))
    assert grid._log_odds.min() >= min(model.miss, model.gap) - 1e-6
    assert grid._log_odds.max() <= model.hit + 1e-6


def test_the_shadow_of_an_edge_stays_unknown() -> None:
    ranges = np.full(181, 5.0)
    ranges[60:121] = 1.0
    grid = OccupancyGrid(CELL)
    grid.integrate(LaserScan(ranges, -math.pi / 2, math.pi / 180, 0.02, 8.0, 0.0), Pose2D(0.0, 0.0))
    angles = np.radians(np.arange(-29, 30))
    for distance in (1.2, 2.0, 4.0):
        for angle in angles:
            assert grid.map.state_at(distance * math.cos(angle), distance * math.sin(angle)) == UNKNOWN


def test_a_wall_is_marked_behind_its_face_and_free_before_it() -> None:
    grid = OccupancyGrid(CELL)
    angles = np.radians(np.arange(-45, 46))
    scan = LaserScan(2.0 / np.cos(angles), angles[0], math.radians(1), 0.02, 8.0, 0.0)
    grid.integrate(scan, Pose2D(0.0, 0.0))
    for y in np.arange(-1.9, 1.9, 0.05):
        assert grid.map.state_at(2.01, y) == OCCUPIED
        assert grid.map.state_at(1.99, y) == FREE


def test_a_distant_wall_has_no_holes_between_the_beams() -> None:
    grid = OccupancyGrid(CELL)
    angles = np.radians(np.arange(-60, 61, 2.0))
    grid.integrate(LaserScan(6.0 / np.cos(angles), angles[0], math.radians(2), 0.02, 20.0, 0.0), Pose2D(0.0, 0.0))
    assert all(grid.map.state_at(6.01, y) == OCCUPIED for y in np.arange(-9.9, 9.9, 0.05))


def test_a_beam_without_return_frees_its_way_up_to_the_range_in_use() -> None:
    grid = OccupancyGrid(CELL, max_range=3.0)
    grid.integrate(scan_of([math.inf] * 181), Pose2D(0.0, 0.0))
    assert grid.map.state_at(2.9, 0.02) == FREE
    assert grid.map.state_at(3.1, 0.02) == UNKNOWN
    assert not (grid.map.states == OCCUPIED).any()


def test_a_beam_without_return_can_be_told_to_say_nothing() -> None:
    grid = OccupancyGrid(CELL, no_return_is_free=False)
    grid.integrate(scan_of([math.inf] * 181), Pose2D(0.0, 0.0))
    assert (grid.map.states == UNKNOWN).all()


def test_broken_beams_say_nothing() -> None:
    grid = OccupancyGrid(CELL)
    grid.integrate(scan_of([math.nan, 0.0, 0.01, -1.0, -math.inf] * 20), Pose2D(0.0, 0.0))
    assert (grid.map.states == UNKNOWN).all()


def test_a_hit_beyond_the_range_in_use_is_no_hit() -> None:
    grid = OccupancyGrid(CELL, max_range=2.0)
    grid.integrate(scan_of([5.0] * 181), Pose2D(0.0, 0.0))
    assert set(np.unique(grid.map.states)) == {UNKNOWN, FREE}


def test_what_went_away_is_freed_again() -> None:
    grid = OccupancyGrid(CELL)
    for _ in range(20):
        grid.integrate(scan_of([1.0] * 181), Pose2D(0.0, 0.0))
    for _ in range(10):
        grid.integrate(scan_of([2.0] * 181), Pose2D(0.0, 0.0))
    assert grid.map.state_at(1.01, 0.01) == FREE


def test_a_full_circle_is_closed() -> None:
    grid = OccupancyGrid(CELL)
    grid.integrate(LaserScan(np.full(360, 2.0), -math.pi, math.tau / 360, 0.02, 8.0, 0.0), Pose2D(0.0, 0.0))
    angles = np.linspace(0, math.tau, 500)
    assert all(grid.map.state_at(1.9 * math.cos(a), 1.9 * math.sin(a)) == FREE for a in angles)


def test_scans_that_turn_the_other_way_mean_the_same() -> None:
    left, right = OccupancyGrid(CELL), OccupancyGrid(CELL)
    ranges = 1.5 + np.sin(np.arange(181) / 9)
    left.integrate(LaserScan(ranges, -math.pi / 2, math.pi / 180, 0.02, 8.0, 0.0), Pose2D(0.01, 0.01, 0.0))
    right.integrate(
        LaserScan(ranges[::-1].copy(), math.pi / 2, -math.pi / 180, 0.02, 8.0, 0.0), Pose2D(0.01, 0.01, 0.0)
    )
    assert (left.map.states != right.map.states).mean() < 1e-3


def test_the_grid_grows_and_keeps_what_it_knows() -> None:
    grid = OccupancyGrid(CELL)
    grid.integrate(scan_of([1.0] * 181), Pose2D(0.0, 0.0))
    first = grid.map
    grid.integrate(scan_of([1.0] * 181), Pose2D(-20.0, 13.0, math.pi))
    known = np.argwhere(first.states != UNKNOWN)
    points = first.to_points(known)
    assert grid.map.shape > first.shape
    assert [grid.map.state_at(x, y) for x, y in points] == first.states[known[:, 0], known[:, 1]].tolist()
    assert np.allclose(np.array(grid.map.origin) / CELL, np.round(np.array(grid.map.origin) / CELL))


def test_the_version_grows_only_when_a_state_changes() -> None:
    grid = OccupancyGrid(CELL)
    assert grid.map.version == 0
    grid.integrate(scan_of([1.0] * 181), Pose2D(0.0, 0.0))
    first = grid.map
    assert first.version == 1
    grid.integrate(scan_of([1.0] * 181), Pose2D(0.0, 0.0))
    assert grid.map is first
    grid.integrate(scan_of([math.nan] * 181), Pose2D(50.0, 0.0))
    assert grid.map is first


def test_a_map_handed_out_never_changes() -> None:
    grid = OccupancyGrid(CELL)
    grid.integrate(scan_of([1.0] * 181), Pose2D(0.0, 0.0))
    first, copy = grid.map, grid.map.states.copy()
    grid.integrate(scan_of([2.0] * 181), Pose2D(0.0, 0.0))
    np.testing.assert_array_equal(first.states, copy)
    assert not grid.map.states.flags.writeable


def test_the_robots_own_place_is_free() -> None:
    grid = OccupancyGrid(CELL)
    grid.clear(0.02, -0.03, 0.18)
    free = grid.map.to_points(np.argwhere(grid.map.states == FREE))
    assert np.hypot(*(free - (0.02, -0.03)).T).max() < 0.18
    assert len(free) == pytest.approx(math.pi * 0.18**2 / CELL**2, rel=0.15)


def test_a_seeded_grid_goes_on_from_the_map() -> None:
    states = np.full((40, 40), FREE, dtype=np.int8)
    states[20, 20], states[0] = OCCUPIED, UNKNOWN
    grid = OccupancyGrid(CELL)
    grid.seed(GridMap(states, CELL, (0.013, -1.0)))
    np.testing.assert_array_equal(grid.map.states, states)
    version = grid.map.version
    grid.integrate(scan_of([0.5] * 181), Pose2D(1.013, 2.0, math.pi / 2))
    assert grid.map.version > version
    assert grid.map.state_at(0.013 + 20.5 * CELL, -1.0 + 20.5 * CELL) == OCCUPIED
    assert grid.map.state_at(1.013, 2.3) == FREE


def test_a_seed_of_another_resolution_is_refused() -> None:
    with pytest.raises(InputError, match=r"resolution 0\.1 m does not suit a grid of 0\.05 m"):
        OccupancyGrid(CELL).seed(GridMap(np.zeros((2, 2), np.int8), 0.1, (0.0, 0.0)))


@pytest.mark.parametrize("resolution", [0.0, -1.0, math.nan])
def test_a_cell_without_size_is_refused(resolution: float) -> None:
    with pytest.raises(InputError, match="resolution"):
        OccupancyGrid(resolution)


def test_a_scan_without_beams_is_refused() -> None:
    with pytest.raises(InputError, match="0 beams"):
        OccupancyGrid().integrate(scan_of([]), Pose2D(0.0, 0.0))


@pytest.mark.parametrize("pose", [Pose2D(math.nan, 0.0), Pose2D(0.0, math.inf), Pose2D(5000.0, 0.0)])
def test_a_pose_that_cannot_be_leaves_the_map_as_it_was(pose: Pose2D) -> None:
    grid = OccupancyGrid(CELL)
    grid.integrate(scan_of([1.0] * 181), Pose2D(0.0, 0.0))
    before = grid.map
    with pytest.raises(InputError, match=r"finite pose|too large"):
        grid.integrate(scan_of([1.0] * 181), pose)
    assert grid.map is before


def test_a_lost_beam_among_others_opens_nothing() -> None:
    ranges = [1.0] * 181
    ranges[90] = math.inf
    grid = OccupancyGrid(CELL)
    grid.integrate(scan_of(ranges), Pose2D(0.0, 0.0))
    assert grid.map.state_at(3.0, 0.01) == UNKNOWN
