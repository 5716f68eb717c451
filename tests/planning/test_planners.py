"""What every global planner must do."""

import subprocess
import sys

import numpy as np
import pytest
from planning_world import DISC, RECTANGLE, RESOLUTION, cluttered, doors, grid_of, random_places, room

from zavis_bt.errors import InputError, ZavisError
from zavis_bt.planning import PLANNERS, Costmap, GeodesicField, PlanningError, make_planner
from zavis_bt.types import OCCUPIED, UNKNOWN, Pose2D

pytestmark = pytest.mark.parametrize("name", PLANNERS)


def plan(name, costmap, start, goal, seed=0):
    return make_planner(name).plan(costmap, start, goal, np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("footprint", [DISC, RECTANGLE], ids=["disc", "rectangle"])
def test_paths_start_and_end_right_fit_everywhere_and_are_no_shorter_than_the_shortest(name, footprint, seed):
    costmap = Costmap(grid_of(cluttered(seed)), footprint)
    field_start, goal = random_places(costmap, 2, seed)
    start = Pose2D(field_start.x + 0.01, field_start.y - 0.007)
    path = plan(name, costmap, start, goal)
    np.testing.assert_allclose(path.points[[0, -1]], [(start.x, start.y), (goal.x, goal.y)], atol=1e-9)
    arcs = np.linspace(0, 1, 60)[:, None]
    pairs = zip(path.points[:-1], path.points[1:], strict=True)
    sampled = np.vstack([begin + arcs * (end - begin) for begin, end in pairs])
    assert costmap.fits(sampled[60:], slack=costmap.slack).all()
    assert costmap.path_fits(path.points[1:])
    shortest = GeodesicField(costmap, start).distances(np.array([[goal.x, goal.y]]))[0]
    assert path.length >= 0.99 * shortest - 1e-6
    assert path.length <= 1.6 * shortest + 0.1


def test_the_same_seed_gives_the_same_path(name):
    costmap = Costmap(grid_of(cluttered(5)), DISC)
    start, goal = random_places(costmap, 2, 1)
    first, second = (plan(name, costmap, start, goal, seed=7).points for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_a_door_as_wide_as_the_robot_is_passed(name):
    path = plan(name, Costmap(grid_of(doors(8)), DISC), Pose2D(2.5, 1.2), Pose2D(4.3, 1.5))
    assert path.length < 2.2


def test_start_and_goal_in_the_same_place_give_two_points(name):
    path = plan(name, Costmap(grid_of(room(40, 40)), DISC), Pose2D(1.0, 1.0), Pose2D(1.0, 1.0))
    assert path.points.shape == (2, 2)
    assert path.length == pytest.approx(0.0, abs=0.1)


def test_a_start_beside_a_wall_gets_out(name):
    costmap = Costmap(grid_of(room(40, 40)), DISC)
    path = plan(name, costmap, Pose2D(0.1, 1.0), Pose2D(1.5, 1.0))
    np.testing.assert_allclose(path.points[0], (0.1, 1.0))
    assert costmap.fits(path.points[1:]).all()


@pytest.mark.parametrize(
    ("goal", "reason"),
    [
        (Pose2D(1.025, 1.525), "goal is in an obstacle"),
        (Pose2D(0.1, 1.0), "goal is too close to an obstacle"),
        (Pose2D(1.6, 0.5), "goal is in unknown space"),
        (Pose2D(5.0, 5.0), "goal is outside of the map"),
        (Pose2D(2.5, 1.5), "no path"),
        (Pose2D(float("nan"), 1.5), "finite"),
    ],
)
def test_what_cannot_be_planned_is_told_with_its_reason(name, goal, reason):
    states = room(60, 60)
    states[30, 20] = OCCUPIED
    states[:, 40] = OCCUPIED
    states[5:15, 30:36] = UNKNOWN
    with pytest.raises(PlanningError, match=reason) as raised:
        plan(name, Costmap(grid_of(states), DISC), Pose2D(0.6, 0.6), goal)
    assert isinstance(raised.value, ZavisError)


def test_a_start_deep_in_an_obstacle_is_told(name):
    states = np.full((60, 60), OCCUPIED)
    states[30:59, 30:59] = 0
    with pytest.raises(PlanningError, match="start is in an obstacle"):
        plan(name, Costmap(grid_of(states), DISC), Pose2D(0.5, 0.5), Pose2D(2.2, 2.2))


def test_unknown_space_is_crossed_only_if_allowed(name):
    states = room(40, 80)
    states[:, 35:45] = UNKNOWN
    start, goal = Pose2D(0.5, 1.0), Pose2D(3.5, 1.0)
    with pytest.raises(PlanningError, match="no path"):
        plan(name, Costmap(grid_of(states), DISC), start, goal)
    path = plan(name, Costmap(grid_of(states), DISC, unknown="allow"), start, goal)
    assert path.length == pytest.approx(3.0, rel=0.2)


def test_planning_prints_nothing_even_at_exit(name):
    code = f"""
import numpy as np
from zavis_bt.planning import Costmap, PlanningError, make_planner
from zavis_bt.types import Footprint, GridMap, Pose2D
states = np.zeros((40, 40), dtype=np.int8); states[:, 30] = 100
costmap = Costmap(GridMap(states, {RESOLUTION}, (0.0, 0.0)), Footprint(0.36, 0.36, disc=True))
planner, rng = make_planner("{name}"), np.random.default_rng(0)
path = planner.plan(costmap, Pose2D(0.5, 0.5), Pose2D(1.0, 1.5), rng)
try:
    planner.plan(costmap, Pose2D(0.5, 0.5), Pose2D(1.9, 1.5), rng)
except PlanningError as error:
    kept = error
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout + done.stderr == ""


def test_a_misspelt_name_gets_a_suggestion(name):
    with pytest.raises(InputError, match=f"no planner '{name}x'.*did you mean"):
        make_planner(name + "x")
