"""The braking rule: room to halt, in every direction, for discs and rectangles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from safety_robot import DISC, RECTANGLE, REST, Body, Layer, square

from zavis_bt.planning.stopping import Course, Outline, Velocity, depths, stays_free
from zavis_bt.types import Footprint, Twist2D

ACCELERATION, LATENCY = 0.8, 0.1


def sent(walls, twist: Twist2D, footprint: Footprint = DISC, fov: float = math.tau, **settings: float) -> Twist2D:
    (told,) = Layer(Body(footprint, walls, fov), **settings).tick(twist, 0)
    return told


def wall_ahead(distance: float) -> list[tuple[float, float, float, float]]:
    return [(distance, -3.0, distance, 3.0)]


@given(distance=st.floats(0.2, 1.5))
@settings(deadline=None)
def test_the_speed_towards_a_wall_leaves_room_for_a_tick_and_braking(distance):
    told = sent(wall_ahead(distance), Twist2D(0.7, 0.0), tolerance=0.0)
    gap = distance - DISC.length / 2 - 0.03
    way = told.linear * LATENCY + told.linear**2 / (2 * ACCELERATION)
    assert told.linear == 0.0 or way <= gap
    if told.linear < 0.7:
        assert way >= gap - 0.04


def test_a_base_that_surely_brakes_harder_may_go_faster():
    gentle, hard = (sent(wall_ahead(0.4), Twist2D(0.7, 0.0), deceleration=d).linear for d in (0.4, 2.0))
    assert 0 < gentle < hard


def test_a_disc_at_a_wall_may_turn_and_leave_but_not_go_on():
    walls = wall_ahead(0.19)
    assert sent(walls, Twist2D(0.5, 0.2)) == Twist2D(0.0, 0.2)
    assert sent(walls, Twist2D(-0.2, 0.0)) == Twist2D(-0.2, 0.0)
    assert sent(walls, Twist2D(0.0, 1.0)) == Twist2D(0.0, 1.0)


def test_reversing_minds_what_is_behind():
    walls = [(-0.3, -3.0, -0.3, 3.0)]
    assert -0.4 < sent(walls, Twist2D(-0.4, 0.0)).linear < 0.0
    assert sent(walls, Twist2D(0.4, 0.0)) == Twist2D(0.4, 0.0)


def test_where_the_lidar_does_not_look_reversing_is_creeping():
    assert sent([], Twist2D(-0.4, 0.0), fov=math.pi) == Twist2D(-0.1, 0.0)
    assert sent([], Twist2D(-0.4, 0.0), fov=math.tau) == Twist2D(-0.4, 0.0)


def test_a_turn_that_would_sweep_an_obstacle_into_a_rectangle_is_refused():
    post = [(0.2, 0.27, 0.22, 0.27)]  # 7 cm beside its front half: inside the circle its corners run on
    assert 0.0 < sent(post, Twist2D(0.0, 1.5), RECTANGLE, tolerance=0.0).angular < 1.2
    touching = [(0.2, 0.201, 0.34, 0.201)]
    assert sent(touching, Twist2D(0.0, 1.0), RECTANGLE, tolerance=0.0).angular < 0.03
    assert sent(post, Twist2D(0.0, 1.5), DISC) == Twist2D(0.0, 1.5)


def test_a_turn_out_of_a_narrow_place_is_allowed():
    corner = [(0.355, -0.2, 0.355, -0.1)]  # ahead of the front's right half: where it turns to on its left
    assert sent(corner, Twist2D(0.0, 1.0), RECTANGLE, tolerance=0.0).angular < 0.3
    assert sent(corner, Twist2D(0.0, -1.0), RECTANGLE, tolerance=0.0) == Twist2D(0.0, -1.0)


def test_an_obstacle_too_near_to_brake_gently_is_braked_for_hard():
    body = Body()
    layer = Layer(body)
    for _ in range(12):
        layer.tick(Twist2D(0.7, 0.0))
    x = body.pose.x + 0.3  # 12 cm ahead of the outline, 31 cm of braking distance
    body.walls = np.array([[x, -1.0, x, 1.0]])
    body.hear()
    body.lidar._last = None
    assert layer.tick(Twist2D(0.7, 0.0)) == ["stop"]


def test_an_outline_that_is_touched_already_may_be_left_but_not_pressed_on():
    walls = wall_ahead(0.17)  # 1 cm inside the disc
    assert sent(walls, Twist2D(0.1, 0.0), tolerance=0.0).linear == 0.0
    assert sent(walls, Twist2D(-0.1, 0.0), tolerance=0.0) == Twist2D(-0.1, 0.0)


def test_the_robots_own_parts_are_no_obstacles():
    mast = [(0.02, -0.02, 0.02, 0.02)]
    assert sent(mast, Twist2D(0.5, 0.5), RECTANGLE) == Twist2D(0.5, 0.5)


def room(rng: np.random.Generator) -> list[tuple[float, float, float, float]]:
    """A room with boxes in it, none of them near the start."""
    walls = square(1.3)
    for _ in range(6):
        angle, distance, turn = rng.uniform(0, math.tau), rng.uniform(0.65, 1.2), rng.uniform(0, math.pi)
        middle = np.array([math.cos(angle), math.sin(angle)]) * distance
        ahead, aside = (
            np.array([math.cos(turn), math.sin(turn)]) * 0.1,
            np.array([-math.sin(turn), math.cos(turn)]) * 0.04,
        )
        corners = [middle + ahead + aside, middle + ahead - aside, middle - ahead - aside, middle - ahead + aside]
        walls += [(*corners[i], *corners[(i + 1) % 4]) for i in range(4)]
    return walls


@pytest.mark.parametrize("footprint", [DISC, RECTANGLE], ids=["disc", "rectangle"])
@given(seed=st.integers(0, 10_000), patience=st.integers(1, 12))
@settings(max_examples=12, deadline=None)
def test_whatever_is_asked_for_the_outline_never_meets_a_wall(footprint, seed, patience):
    rng = np.random.default_rng(seed)
    body = Body(footprint, room(rng))
    layer = Layer(body, tolerance=0.0)
    travelled, asked = 0.0, REST
    for tick in range(80):
        if tick % patience == 0:
            asked = Twist2D(rng.uniform(-0.4, 0.7), rng.choice([0.0, rng.uniform(-1.8, 1.8)]))
        before = body.pose
        layer.tick(asked)
        travelled += before.distance(body.pose)
        assert body.deepest < 0.004  # what fits between two beams and two checked poses
    assert travelled > 0.05


# -- the kernel -------------------------------------------------------------------------------------------------------


def course(linear: float, angular: float, now: Velocity | None = None, extra: float = 0.0) -> Course:
    asked = Velocity(linear, angular)
    brakes = Velocity(0.8, 3.0)
    return Course(now or asked, asked, 0.0, asked, 0.1, brakes, brakes, extra)


def test_straight_on_the_way_until_the_halt_is_reaction_and_braking_distance():
    outline, way = Outline(False, 0.3, 0.3, 0.2), 0.5 * 0.1 + 0.5**2 / (2 * 0.8)
    for beyond, free in ((0.01, True), (-0.015, False)):
        point = np.array([[0.3 + way + beyond, 0.0]])
        assert stays_free(point, outline, course(0.5, 0.0), 0.0) is free


def test_the_extra_way_counts_beyond_the_halt():
    outline, way = Outline(True, 0.2, 0.2, 0.2), 0.5 * 0.1 + 0.5**2 / (2 * 0.8)
    point = np.array([[0.2 + way + 0.05, 0.0]])
    assert stays_free(point, outline, course(0.5, 0.0), 0.0)
    assert not stays_free(point, outline, course(0.5, 0.0, extra=0.07), 0.0)


def test_an_old_state_adds_the_way_driven_since():
    outline, asked = Outline(True, 0.2, 0.2, 0.2), Velocity(0.0, 0.0)
    now, brakes = Velocity(0.5, 0.0), Velocity(0.8, 3.0)
    for delay, free in ((0.0, True), (0.2, False)):
        point = np.array([[0.2 + 0.5**2 / (2 * 0.8) + 0.05, 0.0]])
        assert stays_free(point, outline, Course(now, now, delay, asked, 0.1, brakes, brakes, 0.0), 0.0) is free


@given(x=st.floats(-0.6, 0.6), y=st.floats(-0.6, 0.6), yaw=st.floats(-3, 3))
def test_depth_is_the_distance_to_the_nearest_side_from_inside(x, y, yaw):
    outline = Outline(False, 0.35, 0.25, 0.2)
    ahead, aside = math.cos(yaw) * x + math.sin(yaw) * y, math.cos(yaw) * y - math.sin(yaw) * x
    (depth,) = depths(np.array([[x, y]]), outline, 0.0, 0.0, yaw)
    inside = -0.25 < ahead < 0.35 and abs(aside) < 0.2
    assert (depth > 0) == inside
    if inside:
        assert depth == pytest.approx(min(0.35 - ahead, 0.25 + ahead, 0.2 - abs(aside)))


def test_outlines_of_footprints():
    assert Outline.of(DISC, 0.01) == (True, pytest.approx(0.17), pytest.approx(0.17), pytest.approx(0.17))
    assert Outline.of(RECTANGLE) == (False, pytest.approx(0.35), pytest.approx(0.25), pytest.approx(0.2))
