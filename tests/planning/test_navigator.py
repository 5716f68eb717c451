import math

import numpy as np
import pytest
from planning_world import (
    DISC,
    RECTANGLE,
    Base,
    cluttered,
    doors,
    drive,
    grid_of,
    navigate,
    random_places,
    robot,
    room,
)

from zavis_bt.errors import InputError
from zavis_bt.planning import Costmap, FollowStatus, Navigator, PlanningError
from zavis_bt.types import OCCUPIED, BaseState, LaserScan, Path, Pose2D, Twist2D


def assert_arrived(base, said, goal, tolerance=0.1, yaw_tolerance=None):
    assert said[-1].status is FollowStatus.ARRIVED
    assert said[-1].twist == Twist2D()
    assert base.contacts == 0
    assert base.state.pose.distance(goal) <= tolerance + 0.02
    if yaw_tolerance is not None:
        assert abs(math.remainder(goal.yaw - base.state.pose.yaw, math.tau)) <= yaw_tolerance


@pytest.mark.parametrize(
    ("footprint", "door"), [(DISC, 8), (DISC, 10), (RECTANGLE, 12), (RECTANGLE, 16)], ids=lambda value: str(value)[:9]
)
@pytest.mark.parametrize("start", [Pose2D(1.0, 1.5, 0.0), Pose2D(1.0, 0.6, 2.0)])
def test_a_door_as_wide_as_the_robot_and_an_l_turn_are_driven_without_contact(footprint, door, start):
    states = doors(door)
    goal = Pose2D(6.5, 1.5, 0.0)
    states[1:39, 121:139] = 0  # the corridor turns by a right angle
    goal = Pose2D(6.5, 0.6, -1.5)
    base, said, path = navigate(footprint, states, start, goal, yaw_tolerance=0.1)
    assert_arrived(base, said, goal, yaw_tolerance=0.1)
    assert said[-1].driven == pytest.approx(path.length, rel=0.1)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("footprint", [DISC, RECTANGLE], ids=["disc", "rectangle"])
def test_cluttered_rooms_are_crossed_without_contact(footprint, seed):
    states = cluttered(seed, pieces=8)
    costmap = Costmap(grid_of(states), footprint)
    roomy = [p for p in random_places(costmap, 200, seed) if costmap.clearance(np.array([[p.x, p.y]]))[0] > 0.4]
    start, goal = roomy[0], roomy[1]
    base, said, _ = navigate(footprint, states, start, goal)
    assert_arrived(base, said, goal)


@pytest.mark.parametrize("footprint", [DISC, RECTANGLE], ids=["disc", "rectangle"])
def test_straights_are_driven_straight_and_near_full_speed(footprint):
    start, goal = Pose2D(1.0, 1.0, 0.0), Pose2D(9.0, 1.0, 0.0)
    base, said, _ = navigate(footprint, room(40, 200), start, goal)
    assert_arrived(base, said, goal)
    limits = base.spec.limits
    assert max(p.twist.linear for p in said) > 0.95 * limits.max_linear
    assert base.state.stamp < 1.2 * (8.0 / limits.max_linear + limits.max_linear / limits.linear_acceleration)
    assert max(abs(pose.y - 1.0) for pose in base.trajectory) < 0.03
    turns = np.array([p.twist.angular for p in said])
    assert np.abs(turns).max() < 0.3


def test_a_path_behind_the_robot_is_begun_by_turning_on_the_spot():
    base, said, _ = navigate(DISC, room(60, 120), Pose2D(3.0, 1.5, 0.0), Pose2D(1.0, 1.5, math.pi))
    assert_arrived(base, said, Pose2D(1.0, 1.5))
    turning = [pose for pose in base.trajectory if abs(math.remainder(pose.yaw - math.pi, math.tau)) > 1.1]
    assert all(pose.distance(Pose2D(3.0, 1.5)) < 0.02 for pose in turning)


def test_the_final_heading_is_turned_to_only_if_asked_for():
    goal = Pose2D(3.0, 1.0, -2.0)
    base, said, _ = navigate(DISC, room(40, 80), Pose2D(1.0, 1.0, 0.0), goal)
    assert FollowStatus.TURNING not in {p.status for p in said}
    assert abs(base.state.pose.yaw) < 0.5
    base, said, _ = navigate(DISC, room(40, 80), Pose2D(1.0, 1.0, 0.0), goal, yaw_tolerance=0.05)
    assert FollowStatus.TURNING in {p.status for p in said}
    assert_arrived(base, said, goal, yaw_tolerance=0.05)


def test_remaining_falls_and_driven_grows():
    _, said, path = navigate(DISC, cluttered(2, pieces=6), Pose2D(0.5, 0.5), Pose2D(4.5, 4.5))
    remaining, driven = np.array([p.remaining for p in said]), np.array([p.driven for p in said])
    assert remaining[0] == pytest.approx(path.length)
    assert (np.diff(remaining) < 0.02).all()
    assert (np.diff(driven) >= 0).all()


def test_a_new_wall_across_the_path_makes_it_invalid():
    spec, grids = robot(DISC), [grid_of(room(60, 120), version=1)]
    navigator = Navigator(spec, lambda: grids[-1])
    start, goal = Pose2D(1.0, 1.5), Pose2D(5.0, 1.5)
    follower = navigator.follow(navigator.plan(start, goal), goal)
    base = Base(spec, navigator.costmap, start)
    drive(base, follower, seconds=1.0)
    beside = room(60, 120)
    beside[5:10, 60] = OCCUPIED
    grids.append(grid_of(beside, version=2))
    assert drive(base, follower, seconds=2.0)[-1].status is FollowStatus.DRIVING
    across = room(60, 120)
    across[10:50, 60] = OCCUPIED
    grids.append(grid_of(across, version=3))
    said = drive(base, follower, seconds=4.0)
    assert said[-1].status is FollowStatus.INVALID
    assert said[-1].twist == Twist2D()
    around = navigator.follow(navigator.plan(base.state.pose, goal), goal)
    base.truth = navigator.costmap
    assert_arrived(base, drive(base, around), goal)


def scan_of_board(pose: Pose2D, x: float, y0: float, y1: float) -> LaserScan:
    """Scan of a board that stands across the way at x, and of nothing else."""
    angles = np.linspace(-math.pi / 2, math.pi / 2, 181)
    ahead = np.cos(pose.yaw + angles)
    with np.errstate(divide="ignore"):
        ranges = (x - pose.x) / ahead
    y = pose.y + ranges * np.sin(pose.yaw + angles)
    ranges = np.where((ranges > 0.05) & (y0 <= y) & (y <= y1), ranges, math.inf)
    return LaserScan(ranges, -math.pi / 2, math.pi / 180, 0.05, 10.0, 0.0)


@pytest.mark.parametrize("footprint", [DISC, RECTANGLE], ids=["disc", "rectangle"])
def test_what_only_the_scan_shows_is_not_run_into(footprint):
    spec, grid = robot(footprint), grid_of(room(18, 120))
    navigator = Navigator(spec, lambda: grid)
    start, goal = Pose2D(0.5, 0.45), Pose2D(5.5, 0.45)
    follower = navigator.follow(navigator.plan(start, goal), goal)
    base, said = Base(spec, navigator.costmap, start), []
    while base.state.stamp < 30.0:
        said.append(follower.update(base.state, scan_of_board(base.state.pose, 2.5, 0.2, 0.7)))
        if said[-1].status is not FollowStatus.DRIVING:
            break
        base.run(said[-1].twist)
    assert said[-1].status in (FollowStatus.BLOCKED, FollowStatus.STUCK)
    assert 2.5 - footprint.length / 2 - 0.6 < base.state.pose.x < 2.5 - footprint.length / 2 + 0.035


def test_a_base_that_does_not_move_is_stuck():
    navigator = Navigator(robot(DISC), lambda: grid)
    grid = grid_of(room(60, 120))
    start, goal = Pose2D(1.0, 1.5), Pose2D(5.0, 1.5)
    follower = navigator.follow(navigator.plan(start, goal), goal)
    statuses = [follower.update(BaseState(start, Twist2D(), 0.1 * i), None).status for i in range(40)]
    first = statuses.index(FollowStatus.STUCK)
    assert 20 <= first <= 32
    assert set(statuses[:first]) == {FollowStatus.DRIVING}


def test_a_robot_that_is_carried_away_plans_anew():
    navigator = Navigator(robot(DISC), lambda: grid)
    grid = grid_of(room(100, 100))
    goal = Pose2D(4.0, 1.0)
    follower = navigator.follow(navigator.plan(Pose2D(1.0, 1.0), goal), goal)
    assert follower.update(BaseState(Pose2D(1.0, 1.0), Twist2D(), 0.0), None).status is FollowStatus.DRIVING
    assert follower.update(BaseState(Pose2D(1.0, 3.0), Twist2D(), 0.1), None).status is FollowStatus.INVALID


def test_a_start_in_an_inflated_zone_is_left():
    start, goal = Pose2D(0.16, 1.0, 0.0), Pose2D(1.5, 1.0)
    base, said, _ = navigate(DISC, room(40, 40), start, goal)
    assert_arrived(base, said, goal)


def test_a_goal_where_the_robot_does_not_fit_is_replaced_by_the_nearest_place():
    grid = grid_of(room(40, 80))
    navigator = Navigator(robot(DISC), lambda: grid)
    path = navigator.plan(Pose2D(2.0, 1.0), Pose2D(0.1, 1.0))
    assert np.hypot(*(path.points[-1] - (0.1, 1.0))) <= 0.2
    with pytest.raises(PlanningError, match="goal is too close"):
        navigator.plan(Pose2D(2.0, 1.0), Pose2D(0.1, 1.0), goal_tolerance=0.05)


def test_costmap_and_fields_are_kept_for_the_same_version():
    grids = [grid_of(room(40, 40), version=1)]
    navigator = Navigator(robot(DISC), lambda: grids[-1])
    costmap, field = navigator.costmap, navigator.field(Pose2D(1.0, 1.0, 0.3))
    assert navigator.costmap is costmap
    assert navigator.field(Pose2D(1.0, 1.0, -0.3)) is field
    assert navigator.field(Pose2D(1.1, 1.0)) is not field
    grids.append(grid_of(room(40, 40), version=2))
    assert navigator.costmap is not costmap
    assert navigator.field(Pose2D(1.0, 1.0)) is not field


def test_room_to_turn_and_to_reverse_is_known():
    grid = grid_of(room(40, 40))
    disc, rectangle = (Navigator(robot(footprint), lambda: grid) for footprint in (DISC, RECTANGLE))
    near = Pose2D(0.025 + 0.3, 1.0)
    assert disc.can_turn(near)
    assert not rectangle.can_turn(near)
    assert rectangle.can_turn(Pose2D(1.0, 1.0))
    assert disc.free_behind(Pose2D(0.425, 1.0, 0.0), 0.5) == pytest.approx(0.22, abs=0.021)
    assert disc.free_behind(Pose2D(1.0, 1.0, 0.0), 0.3) == 0.3


def test_a_misspelt_planner_is_told():
    with pytest.raises(InputError, match="did you mean 'astar'"):
        Navigator(robot(DISC), lambda: grid_of(room(9, 9)), planner="aster")


def test_a_path_of_one_place_is_followed_to_its_end():
    grid = grid_of(room(40, 40))
    navigator = Navigator(robot(DISC), lambda: grid)
    here = Pose2D(1.0, 1.0, 0.0)
    follower = navigator.follow(Path(np.array([[1.0, 1.0], [1.0, 1.0]])), here)
    assert follower.update(BaseState(here, Twist2D(), 0.0), None).status is FollowStatus.ARRIVED
