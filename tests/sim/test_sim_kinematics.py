from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.collision import Body, is_free
from sim.kinematics import Contact, Drive, Ground, Motion, OdometryError, Place, advance, at_rest
from zavis_bt.types import Footprint

STEP = 0.02
DISC = Footprint(0.36, 0.36, disc=True)
BOX = Footprint(0.508, 0.497)
NEVER = 10**9


def drive(linear: float, angular: float, expires: int = NEVER) -> Drive:
    return Drive(linear, angular, expires, 1.0 * STEP, 4.0 * STEP)


def ground_of(occupied: np.ndarray) -> Ground:
    return Ground(occupied, 0.05, 0.0, 0.0)


def run(motion: Motion, command: Drive, ground: Ground, footprint: Footprint, steps: int, first: int = 0):
    history = np.zeros((steps, 6))
    motion = advance(
        motion, command, ground, Body.of(footprint, 0.05), first, STEP, history, OdometryError(), np.zeros((steps, 2))
    )
    return motion, np.roll(history, -(first + 1), axis=0)


def moving(linear: float, angular: float) -> Motion:
    place = Place(5.0, 5.0, 0.3)
    return Motion(place, place, linear, angular, 0.0, Contact(False, False, place, 0))


@pytest.fixture
def plain() -> Ground:
    return ground_of(np.pad(np.zeros((198, 198), dtype=np.bool_), 1, constant_values=True))


@pytest.mark.parametrize(("linear", "angular"), [(0.5, 0.0), (0.4, 0.8), (-0.2, 1e-9), (0.0, 1.0)])
def test_constant_twist_follows_its_arc_exactly(plain: Ground, linear: float, angular: float) -> None:
    motion, _ = run(moving(linear, angular), drive(linear, angular), plain, DISC, 150)
    time = 150 * STEP
    if abs(angular) < 1e-6:
        x, y = 5 + linear * time * math.cos(0.3), 5 + linear * time * math.sin(0.3)
    else:
        radius = linear / angular
        x = 5 + radius * (math.sin(0.3 + angular * time) - math.sin(0.3))
        y = 5 - radius * (math.cos(0.3 + angular * time) - math.cos(0.3))
    assert (motion.true.x, motion.true.y) == pytest.approx((x, y), abs=1e-9)
    assert math.remainder(motion.true.yaw - 0.3 - angular * time, math.tau) == pytest.approx(0, abs=1e-9)
    assert motion.travelled == pytest.approx(abs(linear) * time)


def test_velocity_changes_by_the_acceleration(plain: Ground) -> None:
    motion, _ = run(at_rest(5, 5, 0), drive(0.5, 1.0), plain, DISC, 10)
    assert (motion.linear, motion.angular) == pytest.approx((10 * STEP * 1.0, 10 * STEP * 4.0))
    assert motion.true.x > 5
    motion, _ = run(motion, drive(0.5, 1.0), plain, DISC, 100)
    assert (motion.linear, motion.angular) == pytest.approx((0.5, 1.0))


def test_speeding_up_and_braking_cover_the_distance_of_the_trapezoid(plain: Ground) -> None:
    motion, _ = run(at_rest(3, 5, 0), drive(0.5, 0.0, expires=100), plain, DISC, 300)
    # 0.5 s up to 0.5 m/s, 1.5 s at it, 0.5 s down.
    assert motion.true.x == pytest.approx(3 + 0.125 + 0.75 + 0.125)
    assert motion.linear == 0


@pytest.mark.parametrize(("footprint", "front"), [(DISC, None), (BOX, 0.254)])
def test_a_wall_stops_the_base_at_contact(plain: Ground, footprint: Footprint, front: float | None) -> None:
    motion, _ = run(at_rest(9.0, 5.0, 0), drive(0.5, 0.0), plain, footprint, 200)
    wall = 199.5 * 0.05
    # A disc stands at the edge of the last passable cell, whose centre is 0.2 m from the wall's cells.
    assert motion.true.x == pytest.approx(wall - front if front else wall - 0.2 + 0.025, abs=1e-5)
    assert motion.contact.stalled
    assert motion.contact.touching
    assert motion.contact.number == 1
    assert motion.linear == 0


def test_the_base_backs_away_and_a_second_contact_counts_again(plain: Ground) -> None:
    motion, _ = run(at_rest(9.6, 5.0, 0), drive(0.5, 0.0), plain, BOX, 100)
    motion, _ = run(motion, drive(-0.3, 0.0), plain, BOX, 50)
    assert motion.true.x < 9.6
    assert not motion.contact.stalled
    assert not motion.contact.touching
    motion, _ = run(motion, drive(0.5, 0.0), plain, BOX, 200)
    assert motion.contact.number == 2


def test_the_bumper_stays_pressed_at_rest_but_the_wheels_are_free(plain: Ground) -> None:
    motion, _ = run(at_rest(9.6, 5.0, 0), drive(0.5, 0.0), plain, BOX, 100)
    motion, _ = run(motion, drive(0.0, 0.0), plain, BOX, 20)
    assert motion.contact.touching
    assert not motion.contact.stalled


def test_a_disc_can_turn_while_it_touches(plain: Ground) -> None:
    motion, _ = run(at_rest(9.6, 5.0, 0), drive(0.5, 0.0), plain, DISC, 100)
    motion, _ = run(motion, drive(0.5, 1.0), plain, DISC, 30)
    assert motion.true.yaw > 0.3
    assert motion.contact.number == 1


def test_a_rectangle_cannot_turn_beside_a_wall(plain: Ground) -> None:
    start = at_rest(5.0, 199.5 * 0.05 - 0.2486, 0)  # 0.1 mm of room at the side
    motion, _ = run(start, drive(0.0, 1.0), plain, BOX, 100)
    assert abs(motion.true.yaw) < 0.02
    assert motion.contact.stalled
    motion, _ = run(motion, drive(0.0, -1.0), plain, BOX, 5)
    assert motion.true.yaw <= 0.02


@settings(deadline=None, max_examples=40)
@given(
    seed=st.integers(0, 2**32 - 1),
    footprint=st.sampled_from([DISC, BOX, Footprint(0.6, 0.3, centre_x=0.1)]),
    twists=st.lists(st.tuples(st.floats(-0.8, 0.8), st.floats(-2, 2)), min_size=3, max_size=8),
)
def test_the_base_never_overlaps_an_obstacle(
    seed: int, footprint: Footprint, twists: list[tuple[float, float]]
) -> None:
    rng = np.random.default_rng(seed)
    occupied = np.pad(rng.random((58, 58)) < 0.02, 1, constant_values=True)
    occupied[22:38, 22:38] = False
    ground, body = ground_of(occupied), Body.of(footprint, 0.05)
    motion = at_rest(1.5, 1.5, rng.uniform(-3, 3))
    if not is_free(occupied, body, 29.5, 29.5, motion.true.yaw):
        return
    for linear, angular in twists:
        motion, history = run(motion, drive(linear, angular), ground, footprint, 100)
        for x, y, yaw in history[:, :3]:
            assert is_free(occupied, body, x / 0.05 - 0.5, y / 0.05 - 0.5, yaw)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 2**32 - 1), yaw=st.floats(-3, 3), speed=st.floats(0.1, 0.8))
def test_whatever_was_hit_can_be_left_the_way_it_was_reached(seed: int, yaw: float, speed: float) -> None:
    occupied = np.pad(np.random.default_rng(seed).random((58, 58)) < 0.01, 1, constant_values=True)
    occupied[24:36, 24:36] = False
    for footprint in (DISC, Footprint(0.5, 0.2)):
        if not is_free(occupied, Body.of(footprint, 0.05), 29.5, 29.5, yaw):
            continue
        motion, _ = run(at_rest(1.5, 1.5, yaw), drive(speed, 0.0), ground_of(occupied), footprint, 1500)
        assert motion.contact.number == 1
        back, _ = run(motion, drive(-speed, 0.0), ground_of(occupied), footprint, 10)
        assert math.hypot(back.true.x - motion.true.x, back.true.y - motion.true.y) > 0.01


def test_odometry_error_grows_with_the_way_not_with_the_number_of_steps(plain: Ground) -> None:
    error = OdometryError(True, 0.0, 0.01, 0.004, 0.0)

    def final(seed: int, step: float) -> Place:
        steps = round(4.0 / step)
        normals = np.random.default_rng(seed).standard_normal((steps, 2))
        body, history = Body.of(DISC, 0.05), np.zeros((2, 6))
        command = Drive(0.5, 0.0, NEVER, 1.0, 1.0)
        return advance(moving(0.5, 0.0), command, plain, body, 0, step, history, error, normals).odometry

    for step in (0.02, 0.005):
        yaws = np.array([final(seed, step).yaw for seed in range(300)]) - 0.3
        assert yaws.std() == pytest.approx(math.sqrt(0.01 * 2.0), rel=0.15)
