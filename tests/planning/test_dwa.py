import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planning_world import DISC, RECTANGLE, Base, cluttered, grid_of, random_places, robot, room

from zavis_bt.planning import Costmap, DwaPlanner, DwaSettings
from zavis_bt.types import OCCUPIED, LaserScan, Pose2D, Twist2D

OPEN = Costmap(grid_of(room(100, 100)), DISC)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 9), st.floats(-3, 3), st.floats(0, 0.6), st.floats(-1.5, 1.5), st.booleans())
def test_after_any_command_the_base_can_brake_without_contact(seed, yaw, linear, angular, disc):
    footprint = DISC if disc else RECTANGLE
    spec, costmap = robot(footprint), Costmap(grid_of(cluttered(seed)), footprint)
    place, target = random_places(costmap, 2, seed)
    base = Base(spec, costmap, Pose2D(place.x, place.y, yaw))
    if not costmap.pose_fits(base.state.pose):
        return
    planner, twist = DwaPlanner(spec), Twist2D()
    for _ in range(12):
        chosen = planner.command(base.state.pose, base.state.twist, (target.x, target.y), costmap, 0.1)
        if chosen is None:
            break
        twist = chosen
        base.run(twist)
        assert abs(twist.linear) <= spec.limits.max_linear + 1e-9
        assert abs(twist.angular) <= spec.limits.max_angular + 1e-9
    for _ in range(40):
        base.run(Twist2D())
    assert base.contacts == 0


def test_commands_stay_within_what_the_base_can_reach():
    spec = robot(DISC)
    now = Twist2D(0.3, 0.2)
    chosen = DwaPlanner(spec).command(Pose2D(2.0, 2.0, 0.0), now, (4.0, 2.5), OPEN, 0.1)
    assert abs(chosen.linear - now.linear) <= spec.limits.linear_acceleration * 0.1 + 1e-9
    assert abs(chosen.angular - now.angular) <= spec.limits.angular_acceleration * 0.1 + 1e-9


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_base_steers_towards_its_target(side):
    chosen = DwaPlanner(robot(DISC)).command(Pose2D(2.0, 2.5, 0.0), Twist2D(0.4), (2.8, 2.5 + side * 0.5), OPEN, 0.1)
    assert chosen.angular * side > 0.1


def test_the_speed_limit_is_kept_once_it_can_be():
    planner = DwaPlanner(robot(DISC))
    slow = planner.command(Pose2D(1.0, 2.5), Twist2D(0.2), (4.0, 2.5), OPEN, 0.1, speed_limit=0.15)
    braking = planner.command(Pose2D(1.0, 2.5), Twist2D(0.6), (4.0, 2.5), OPEN, 0.1, speed_limit=0.15)
    assert slow.linear <= 0.15 + 1e-9
    assert braking.linear == pytest.approx(0.5)


def test_no_motion_is_admissible_against_a_wall_at_full_speed():
    states = room(100, 100)
    states[:, 60] = OCCUPIED
    costmap = Costmap(grid_of(states), DISC)
    assert DwaPlanner(robot(DISC)).command(Pose2D(2.8, 2.5), Twist2D(0.6), (4.5, 2.5), costmap, 0.1) is None


def test_turning_goes_the_short_way_and_stops_at_the_heading():
    spec = robot(DISC)
    base, planner = Base(spec, OPEN, Pose2D(2.5, 2.5, 0.0)), DwaPlanner(spec)
    for _ in range(50):
        base.run(planner.turn(base.state.pose, base.state.twist, -2.0, OPEN, 0.1))
    assert base.state.pose.yaw == pytest.approx(-2.0, abs=0.02)
    assert min(pose.yaw for pose in base.trajectory) > -2.1
    assert base.state.twist.angular == pytest.approx(0.0, abs=0.05)


def test_a_rectangle_turns_the_long_way_where_the_short_one_is_barred():
    states = room(100, 100)
    states[56, 54] = OCCUPIED  # in the way of the left front corner
    costmap = Costmap(grid_of(states), RECTANGLE)
    pose = Pose2D(2.5, 2.55, 0.0)
    assert costmap.pose_fits(pose)
    assert costmap.clearance(np.array([[2.5, 2.55]]))[0] < RECTANGLE.circumscribed_radius
    twist = DwaPlanner(robot(RECTANGLE)).turn(pose, Twist2D(), 0.5, costmap, 0.1)
    assert twist is None or twist.angular < 0


def test_scan_points_off_the_map_are_obstacles_and_those_on_it_are_not():
    states = room(100, 100)
    states[:, 70] = OCCUPIED
    costmap = Costmap(grid_of(states), DISC)
    ranges = np.full(181, math.inf)
    ranges[88:93] = 0.6  # nothing there on the map
    ranges[100] = ranges[101] = 1.02  # the wall, a little off
    ranges[10], ranges[11] = math.nan, 0.01
    scan = LaserScan(ranges, -math.pi / 2, math.pi / 180, 0.05, 10.0, 0.0)
    points = DwaPlanner(robot(DISC)).obstacles(Pose2D(2.5, 2.5, 0.0), scan, costmap)
    assert 1 <= len(points) <= 5
    np.testing.assert_allclose(points[:, 0], 3.1, atol=0.01)


def test_settings_are_used():
    planner = DwaPlanner(robot(DISC), DwaSettings(speeds=2, rates=3))
    twist = planner.command(Pose2D(2.0, 2.5), Twist2D(0.3), (4.0, 2.5), OPEN, 0.1)
    assert twist.linear in (pytest.approx(0.2), pytest.approx(0.4))
