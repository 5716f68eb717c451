import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planning_world import DISC, RECTANGLE, RESOLUTION, cluttered, grid_of, room

from zavis_bt.errors import InputError
from zavis_bt.planning import Costmap, Costmaps
from zavis_bt.types import FREE, OCCUPIED, UNKNOWN, Footprint, Pose2D


def occupied_centres(costmap: Costmap) -> np.ndarray:
    return costmap.grid.to_points(np.argwhere(costmap.grid.states == OCCUPIED))


@pytest.mark.parametrize(("gap", "open_"), [(7, False), (8, True)])
def test_a_passage_is_open_from_where_a_cell_has_the_radius_on_both_sides(gap, open_):
    states = room(40, 40)
    states[:, 20] = OCCUPIED
    states[10 + 1 : 10 + gap, 20] = FREE  # jambs' centres are gap cells apart
    assert Costmap(grid_of(states), DISC).passable[:, 20].any() == open_


def test_passable_is_the_costmap_convention():
    costmap = Costmap(grid_of(cluttered(1)), DISC)
    cells = np.argwhere(np.ones(costmap.grid.shape, dtype=bool))
    centres = costmap.grid.to_points(cells)
    distance = np.hypot(*(centres[:, None] - occupied_centres(costmap)).transpose(2, 0, 1)).min(axis=1)
    assert np.array_equal(costmap.passable.ravel(), distance >= 0.18 - 1e-9)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 20), st.floats(0.2, 4.8), st.floats(0.2, 4.8), st.floats(-4, 4))
def test_poses_and_points_fit_where_no_obstacle_centre_is_inside(seed, x, y, yaw):
    for footprint in (DISC, RECTANGLE, Footprint(0.7, 0.4, centre_x=0.1)):
        costmap = Costmap(grid_of(cluttered(seed)), footprint)
        dx, dy = (occupied_centres(costmap) - (x, y)).T
        nearest = float(np.hypot(dx, dy).min())
        assert costmap.clearance(np.array([[x, y]]))[0] == pytest.approx(nearest, abs=2e-3)
        ahead, aside = math.cos(yaw) * dx + math.sin(yaw) * dy, math.cos(yaw) * dy - math.sin(yaw) * dx
        reach = footprint.length / 2
        depth = np.minimum(reach - np.abs(ahead - footprint.centre_x), footprint.width / 2 - np.abs(aside)).max()
        depth = footprint.length / 2 - nearest if footprint.disc else depth
        if abs(depth) > 3e-3:
            assert costmap.pose_fits(Pose2D(x, y, yaw)) == (depth < 0)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 20), *[st.floats(0.3, 4.7)] * 4)
def test_a_line_fits_where_all_its_points_do(seed, x0, y0, x1, y1):
    costmap = Costmap(grid_of(cluttered(seed)), DISC)
    points = np.linspace((x0, y0), (x1, y1), 400)
    centres = occupied_centres(costmap)
    closest = np.hypot(*(points[:, None] - centres).transpose(2, 0, 1)).min()
    if abs(closest - 0.18) > 1e-3:
        assert costmap.line_fits((x0, y0), (x1, y1)) == (closest > 0.18)


def test_steps_between_passable_cells_fit_within_the_slack():
    costmap = Costmap(grid_of(cluttered(3, pieces=30)), DISC)
    diagonal = np.argwhere(costmap.passable[:-1, :-1] & costmap.passable[1:, 1:])
    assert all(costmap.path_fits(costmap.grid.to_points(np.array([cell, cell + 1]))) for cell in diagonal)


def test_unknown_is_avoided_allowed_at_a_price_or_an_obstacle():
    states = room(40, 40)
    states[15:25, 15:25] = UNKNOWN
    grid = grid_of(states)
    avoid, allow, obstacle = (Costmap(grid, DISC, unknown=rule) for rule in ("avoid", "allow", "obstacle"))
    assert not avoid.passable[20, 20]
    assert avoid.passable[20, 13]
    assert avoid.distance[20, 13] > 0.5
    assert allow.passable[20, 20]
    assert allow.cost[20, 20] > 2.0
    assert not obstacle.passable[20, 13]
    assert not obstacle.fits(np.array([[0.65, 1.025]]))[0]


def test_outside_of_the_map_nothing_fits():
    grid = grid_of(np.zeros((20, 20)))
    assert not Costmap(grid, DISC).fits(np.array([[-0.1, 0.5], [1.2, 0.5]])).any()
    assert Costmap(grid, DISC).passable.all()
    assert not Costmap(grid, DISC, unknown="obstacle").passable[0].any()


def test_an_unknown_rule_is_named_with_a_suggestion():
    mistyped: Any = "avoi"
    with pytest.raises(InputError, match=r"no rule 'avoi'.*did you mean 'avoid'"):
        Costmap(grid_of(room(9, 9)), DISC, unknown=mistyped)


@pytest.mark.parametrize("footprint", [DISC, RECTANGLE])
def test_cost_falls_with_clearance_and_forbids_nothing_that_fits(footprint):
    costmap = Costmap(grid_of(room(60, 60)), footprint)
    assert np.array_equal(np.isfinite(costmap.cost), costmap.passable)
    across = costmap.cost[30, :31][costmap.passable[30, :31]]
    assert (np.diff(across) <= 1e-6).all()
    assert across[-1] == 1.0
    assert across[0] > 1.5


def test_a_rectangle_is_tight_where_it_fits_but_cannot_turn():
    costmap = Costmap(grid_of(room(60, 60)), RECTANGLE)
    assert not (costmap.tight & ~costmap.passable).any()
    assert (costmap.distance[costmap.tight] < RECTANGLE.circumscribed_radius).all()
    assert not Costmap(grid_of(room(60, 60)), DISC).tight.any()


def test_nearest_passable_is_the_nearest():
    costmap = Costmap(grid_of(room(40, 40)), DISC)
    assert costmap.nearest_passable(0.125, 1.025, 0.3) == (20, 4)
    assert costmap.nearest_passable(0.125, 1.025, 0.05) is None


def test_costmaps_are_kept_until_the_version_changes():
    grids = [grid_of(room(30, 30), version=1)]
    costmaps = Costmaps(lambda: grids[-1], DISC)
    first = costmaps.current
    assert costmaps.current is first
    grids.append(grid_of(room(40, 40), version=2))
    assert costmaps.version == 2
    assert costmaps.current.grid is grids[-1]


def test_points_and_cells_agree():
    costmap = Costmap(grid_of(room(30, 30)), DISC)
    points = np.array([[0.025, 0.075], [0.5, 0.6]])
    np.testing.assert_allclose(costmap.to_uv(points)[0], (0.0, 1.0), atol=1e-12)
    np.testing.assert_allclose(costmap.to_points(costmap.to_uv(points)), points)
    assert costmap.grid.resolution == RESOLUTION
