from __future__ import annotations

import itertools
import math

import pytest
from arcos_bench import CENTRE, HALL, STEP, Bench, changes, raw
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.pioneer.codec import CommandNumber, Flags, encode_wheels
from sim.devices.arcos.limits import Axis
from sim.devices.arcos.profile import arrive, ramp
from zavis_bt.types import Pose2D, wrap_angle

C = CommandNumber
SLACK = 1e-9


@pytest.fixture
def bench() -> Bench:
    return Bench(HALL, CENTRE)


def axis(speed: float, acceleration: float, deceleration: float) -> Axis:
    return Axis(speed, acceleration, deceleration, 10.0, 10.0, 0.001)


@given(
    st.floats(-3.0, 3.0),
    st.floats(-1.0, 1.0),
    st.floats(0.05, 1.0),
    st.floats(0.1, 4.0),
    st.floats(0.1, 4.0),
)
def test_arriving_ends_at_rest_on_the_mark_within_the_bounds(
    way: float, speed: float, top: float, acceleration: float, deceleration: float
) -> None:
    bounds, remaining = axis(top, acceleration, deceleration), way
    crossings = 0
    for _ in range(20000):
        wanted, change = arrive(remaining, speed, bounds, STEP)
        following = speed + min(max(wanted - speed, -change * STEP), change * STEP)
        assert abs(following - speed) <= max(acceleration, deceleration) * STEP + SLACK
        assert abs(following) <= max(top, abs(speed)) + SLACK
        driven = (speed + following) / 2 * STEP
        crossings += remaining * (remaining - driven) < 0 and abs(remaining) > 1e-3
        remaining, speed = remaining - driven, following
        if abs(remaining) < 1e-6 and speed == 0.0:
            break
    assert abs(remaining) < 1e-4
    assert abs(speed) < 1e-3
    assert crossings <= 2


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_a_ramp_reaches_what_is_wanted_and_rests_where_it_turns_back(speed: float, wanted: float) -> None:
    bounds = axis(1.0, 0.5, 0.8)
    speeds = [speed]
    for _ in range(400):
        target, change = ramp(speed, wanted, bounds)
        assert change == (0.5 if abs(target) > abs(speed) else 0.8)
        speed += min(max(target - speed, -change * STEP), change * STEP)
        speeds.append(speed)
    assert speed == pytest.approx(wanted)
    assert all(before * after >= 0 for before, after in itertools.pairwise(speeds))


@settings(max_examples=15, deadline=None)
@given(st.lists(st.tuples(st.integers(-1500, 1500), st.integers(-400, 400)), min_size=1, max_size=4))
def test_speeds_and_accelerations_keep_to_the_bounds_whatever_is_commanded(orders: list[tuple[int, int]]) -> None:
    bench = Bench(HALL, CENTRE)
    motions = []
    for translation, rotation in orders:
        bench.send(C.VEL, translation)
        bench.send(C.RVEL, rotation)
        motions += bench.run(0.8)
    assert max(abs(motion.linear) for motion in motions) <= 0.75 + SLACK
    assert max(abs(motion.angular) for motion in motions) <= math.radians(100) + SLACK
    assert max(map(abs, changes(motions, "linear"))) <= 0.3 + SLACK
    assert max(map(abs, changes(motions, "angular"))) <= math.radians(100) + SLACK


@pytest.mark.parametrize("millimetres", [1, 5, 40, 300, 2500, -3, -700])
def test_move_lands_on_the_distance_and_never_passes_it(millimetres: int) -> None:
    bench = Bench(HALL, CENTRE)
    bench.send(C.MOVE, millimetres)
    motions = bench.run(9.0)
    ways = [motion.true.x * 1000 for motion in motions]
    assert ways[-1] == pytest.approx(millimetres, abs=0.2)
    assert motions[-1].linear == pytest.approx(0.0, abs=1e-4)
    assert max(way * math.copysign(1, millimetres) for way in ways) <= abs(millimetres) + 0.2


def test_a_new_speed_ends_a_move(bench: Bench) -> None:
    bench.send(C.MOVE, 5000)
    bench.run(1.0)
    bench.send(C.VEL, 0)
    assert bench.run(4.0)[-1].true.x < 0.5


def test_move_keeps_to_the_speed_and_slows_down_as_told(bench: Bench) -> None:
    for number, value in ((C.SETV, 400), (C.SETA, 800), (C.SETA, -200)):
        bench.send(number, value)
    bench.send(C.MOVE, 1500)
    motions = bench.run(8.0)
    assert max(motion.linear for motion in motions) == pytest.approx(0.4)
    assert max(changes(motions, "linear")) == pytest.approx(0.8, abs=1e-6)
    assert min(changes(motions, "linear")) == pytest.approx(-0.2, abs=1e-6)
    assert motions[-1].true.x == pytest.approx(1.5, abs=2e-4)


@settings(max_examples=12, deadline=None)
@given(st.integers(-720, 720), st.integers(-90, 90))
def test_the_robot_turns_to_a_heading_from_any_rotation(degrees: int, spin: int) -> None:
    bench = Bench(HALL, CENTRE)
    bench.send(C.RVEL, spin)
    bench.run(0.6)
    for _ in range(12):  # clients repeat it
        bench.send(C.HEAD, degrees)
        motions = bench.run(0.5)
    assert wrap_angle(motions[-1].true.yaw - math.radians(degrees)) == pytest.approx(0.0, abs=1e-4)
    assert motions[-1].angular == pytest.approx(0.0, abs=1e-4)
    assert bench.sip().control == bench.sip().heading


def test_relative_headings_count_from_now_or_from_the_last_setpoint(bench: Bench) -> None:
    bench.send(C.DHEAD, 60)
    bench.run(0.2)
    bench.send(C.DCHEAD, 30)
    assert math.degrees(bench.run(4.0)[-1].true.yaw) == pytest.approx(90, abs=0.01)
    bench.send(C.DHEAD, -120)
    assert math.degrees(bench.run(4.0)[-1].true.yaw) == pytest.approx(-30, abs=0.01)


def test_a_heading_is_meant_in_the_robots_own_odometry_frame() -> None:
    bench = Bench(HALL, Pose2D(0.0, 0.0, 2.0))
    bench.send(C.HEAD, 90)
    assert bench.run(4.0)[-1].true.yaw == pytest.approx(wrap_angle(2.0 + math.pi / 2), abs=1e-4)


def test_translation_and_rotation_do_not_disturb_each_other(bench: Bench) -> None:
    bench.send(C.VEL, 300)
    bench.send(C.RVEL, 30)
    after = bench.run(2.0)[-1]
    assert (after.linear, after.angular) == pytest.approx((0.3, math.radians(30)))
    bench.send(C.HEAD, 0)
    assert bench.run(5.0)[-1].linear == pytest.approx(0.3)
    bench.send(C.VEL, -200)
    after = bench.run(4.0)[-1]
    assert after.linear == pytest.approx(-0.2)
    assert after.true.yaw == pytest.approx(0.0, abs=1e-4)
    bench.send(C.RVEL, -20)
    assert bench.run(2.0)[-1].angular == pytest.approx(math.radians(-20))


def test_vel2_drives_the_wheels_and_ends_with_any_other_speed(bench: Bench) -> None:
    bench.packet(encode_wheels(-5, 15))
    after = bench.run(3.0)[-1]
    assert after.linear == pytest.approx(0.1)
    assert after.angular == pytest.approx(200 * 0.0034)
    bench.send(C.VEL, 100)
    after = bench.run(3.0)[-1]
    assert (after.linear, after.angular) == pytest.approx((0.1, 0.0))


@pytest.mark.parametrize("number", [C.STOP, C.E_STOP, C.E_STOP_ALTERNATIVE])
@pytest.mark.parametrize("argument", [None, 1])
def test_stopping_ends_all_motion_and_keeps_the_motors_on(bench: Bench, number: int, argument: int | None) -> None:
    bench.send(C.MOVE, 9000)
    bench.send(C.HEAD, 170)
    bench.run(1.2)
    bench.send(number, argument)
    motions = bench.run(2.0)
    assert motions[-1].linear == motions[-1].angular == 0.0
    assert motions[-1].true == motions[-20].true
    assert bench.sip().flags & Flags.MOTORS_ENABLED
    hardest = -min(changes(motions, "linear"))
    assert hardest == pytest.approx(0.3, abs=1e-6) if number == C.STOP else hardest > 3.0


def test_motion_commands_are_dropped_while_an_emergency_stop_is_in_progress(bench: Bench) -> None:
    bench.send(C.SETA, 2000)
    bench.send(C.VEL, 700)
    bench.run(1.5)
    bench.send(C.E_STOP)
    bench.run(0.1)
    bench.send(C.VEL, 500)
    assert bench.run(1.0)[-1].linear == 0.0
    bench.send(C.VEL, 500)
    assert bench.run(1.0)[-1].linear == pytest.approx(0.5)


def test_setpoints_are_clipped_to_the_present_bound_and_that_to_the_top(bench: Bench) -> None:
    bench.send(C.SETA, 9000)
    bench.send(C.SETRA, 9000)
    bench.send(C.VEL, 5000)
    bench.send(C.RVEL, 1000)
    after = bench.run(3.0)[-1]
    assert (after.linear, after.angular) == pytest.approx((0.75, math.radians(100)))
    bench.send(C.SETV, 30000)
    bench.send(C.SETRV, 30000)
    after = bench.run(3.0)[-1]
    assert (after.linear, after.angular) == pytest.approx((1.2, math.radians(300)))
    bench.send(C.SETV, 300)
    assert bench.run(6.0)[-1].linear == pytest.approx(0.3)


def test_a_client_that_sends_twos_complement_is_understood(bench: Bench) -> None:
    bench.packet(raw(C.VEL, 0x3B, 0xCE, 0xFF))
    assert bench.run(1.0)[-1].linear == pytest.approx(-0.05)
