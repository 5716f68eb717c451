from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from arcos_bench import CENTRE, HALL, Bench
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.pioneer.codec import (
    CommandNumber,
    PacketType,
    decode_aux,
    decode_encoders,
)
from sim.devices.arcos import P3AT
from sim.world import World
from zavis_bt.types import Pose2D

C = CommandNumber


@pytest.fixture
def bench() -> Bench:
    return Bench(HALL, CENTRE)


def test_odometry_wraps_at_16_bits_and_never_leaps() -> None:
    bench = Bench(HALL, CENTRE, model=replace(P3AT, distance_factor=0.05))  # so that a short way is long
    for number, value in ((C.SETA, 4000), (C.SETRA, 600), (C.VEL, -700), (C.RVEL, 40)):
        bench.send(number, value)
    xs = []
    for _ in range(100):
        bench.run(0.1)
        xs.append(bench.sip().x)
    steps = np.diff(xs)
    assert min(xs) >= 0
    assert max(xs) <= 0xFFFF
    assert (steps > 0x8000).any()
    assert np.abs((steps + 0x8000) % 0x10000 - 0x8000).max() <= 0.75 * 0.1 / 0.05e-3 + 2


@settings(max_examples=20, deadline=None)
@given(st.integers(-750, 750), st.integers(-100, 100), st.floats(-3.1, 3.1))
def test_a_report_agrees_with_the_plant(speed: int, degrees: int, yaw: float) -> None:
    bench = Bench(HALL, Pose2D(1.0, -2.0, yaw))
    bench.send(C.VEL, speed)
    bench.send(C.RVEL, degrees)
    motion = bench.run(0.9)[-1]
    sip = bench.sip()
    pose = Pose2D(1.0, -2.0, yaw).inverse() @ Pose2D(*motion.true)
    assert (signed(sip.x), signed(sip.y)) == pytest.approx((pose.x * 1000, pose.y * 1000), abs=0.51)
    assert sip.heading * math.tau / 4096 == pytest.approx(pose.yaw, abs=0.0008)
    assert (sip.left_velocity + sip.right_velocity) / 2 == pytest.approx(motion.linear * 1000, abs=0.51)
    turning = (sip.right_velocity - sip.left_velocity) / 2 * 0.0034
    assert turning == pytest.approx(motion.angular, abs=0.0034)
    assert sip.rotational_velocity == pytest.approx(math.degrees(motion.angular) * 10, abs=0.51)
    assert sip.moving == (motion.linear != 0.0 or motion.angular != 0.0)


def signed(value: int) -> int:
    return (value + 0x8000) % 0x10000 - 0x8000


def test_the_battery_follows_the_charge_unless_another_is_pretended(bench: Bench) -> None:
    bench.plant.charge = 0.5
    sip = bench.sip()
    assert (sip.battery, sip.battery_x10, sip.charge_percent) == (120, 120, 50)
    bench.send(C.BATTEST, 114)
    sip = bench.sip()
    assert (sip.battery, sip.charge_percent) == (114, 20)
    bench.send(C.BATTEST, 0)
    assert bench.sip().battery == 120


@pytest.mark.parametrize(("speed", "ahead"), [(300, True), (-300, False)])
def test_driving_into_a_wall_stalls_and_presses_the_bumper_at_that_end(room: World, speed: int, ahead: bool) -> None:
    bench = Bench(room, Pose2D(4.2 if ahead else 0.8, 2.0))
    bench.send(C.VEL, speed)
    touching = [motion.contact.touching for motion in bench.run(5.0)]
    assert any(touching)
    sip = bench.sip()
    assert sip.left_stalled
    assert sip.right_stalled
    pressed, other = (sip.front_bumpers, sip.rear_bumpers) if ahead else (sip.rear_bumpers, sip.front_bumpers)
    assert pressed & 0b00100
    assert pressed < 1 << 5
    assert not other
    assert not sip.moving
    bench.send(C.VEL, -speed)
    bench.run(2.0)
    sip = bench.sip()
    assert sip.left_stall == sip.right_stall == 0
    assert sip.moving


def test_a_bumper_feels_at_which_side_the_obstacle_is(room: World) -> None:
    bench = Bench(room, Pose2D(4.2, 2.0, 0.5))
    bench.send(C.VEL, 300)
    bench.run(4.0)
    assert bench.sip().front_bumpers & 0b11 == 0  # segments are numbered from the left, the wall is at the right
    assert bench.sip().front_bumpers


def test_a_short_bump_between_two_reports_is_not_missed(room: World) -> None:
    bench = Bench(room, Pose2D(4.2, 2.0))
    bench.send(C.VEL, 300)
    while not bench.plant.motion.contact.stalled:
        bench.plant.step()
        bench.send(C.PULSE)
    bench.send(C.VEL, -300)
    bench.run(0.1)
    assert bench.sip().left_stalled


@pytest.mark.parametrize(("mode", "stays"), [(0, False), (1, True), (2, False), (3, True)])
def test_a_bump_ends_the_motion_where_it_is_told_to(room: World, mode: int, stays: bool) -> None:
    bench = Bench(room, Pose2D(4.2, 2.0))
    bench.send(C.BUMPSTALL, mode)
    bench.send(C.VEL, 300)
    bench.run(5.0)
    assert bench.sip().left_stalled != stays  # a robot that still pushes is still stalled
    bench.send(C.VEL, -300)
    assert bench.run(1.5)[-1].linear == pytest.approx(-0.3)


def test_sonar_measures_the_room(room: World) -> None:
    bench = Bench(room, Pose2D(2.5, 2.0))
    heard: dict[int, int] = {}
    for _ in range(8):
        bench.run(0.1)
        readings = bench.sip().sonar
        assert 2 <= len(readings) <= 6
        heard |= dict(readings)
    assert sorted(heard) == list(range(16))
    assert heard[0] == pytest.approx(2000 - 136, abs=2)  # straight to the left
    assert heard[8] == pytest.approx(2000 - 136, abs=2)
    assert heard[3] == pytest.approx(2500 - 245, abs=60)
    assert heard[11] == pytest.approx(2500 - 241, abs=60)


def test_without_an_echo_the_sonar_tells_its_longest_range(bench: Bench) -> None:
    bench.run(0.2)
    assert {distance for _, distance in bench.sip().sonar} == {5000}


@pytest.mark.parametrize(
    ("argument", "numbers"),
    [(0, set()), (1, set(range(16))), (0b010, set(range(8, 16))), (0b100, set(range(8)))],
)
def test_sonar_arrays_can_be_switched(bench: Bench, argument: int, numbers: set[int]) -> None:
    bench.send(C.SONAR, argument)
    bench.run(0.1)
    bench.sip()
    bench.run(0.6)
    assert {number for number, _ in bench.sip().sonar} == numbers
    assert bench.firmware.controller.sonar.flags == 2 * (0 in numbers) + 4 * (8 in numbers)


def test_the_sonars_order_and_pace_can_be_chosen(bench: Bench) -> None:
    bench.send(C.POLLING, bytes((3, 5)))
    bench.send(C.SONARCYCLE, 200)
    bench.run(0.2)
    bench.sip()
    bench.run(1.0)
    front = [number for number, _ in bench.sip().sonar if number < 8]
    assert sorted(front) == [2, 4]
    assert len(bench.sip().sonar) == 0


def test_encoders_count_the_way_of_each_wheel(bench: Bench) -> None:
    bench.send(C.ENCODER, 2)
    bench.send(C.MOVE, 1000)
    bench.run(5.0)
    left, right = decode_encoders(bench.packets()[1])
    assert left == right == pytest.approx(138_000, abs=30)
    bench.send(C.DHEAD, 90)
    bench.run(4.0)
    left, right = np.array(decode_encoders(bench.packets()[1])) - (left, right)
    assert right == -left == pytest.approx(math.pi / 2 / 0.0034 * 138, abs=200)
    bench.send(C.ENCODER, 0)
    assert len(bench.packets()) == 1
    bench.send(C.ENCODER, 1)
    assert [len(bench.packets()) for _ in range(3)] == [2, 1, 1]


def test_inputs_and_outputs_are_told_when_asked_for(bench: Bench) -> None:
    bench.send(C.DIGOUT, 0x0F05)
    bench.send(C.DIGOUT, 0x0102)
    bench.send(C.IOREQUEST, 1)
    _, inputs = bench.packets()
    assert inputs[0] == PacketType.IO
    assert inputs[7] == 0x04
    assert len(inputs) == 27
    assert bench.sip().digital_out == 0x04
    assert len(bench.packets()) == 1


def test_bytes_pass_through_an_auxiliary_port(bench: Bench) -> None:
    written: list[bytes] = []
    port = bench.firmware.controller.aux[0]
    port.write = written.append
    bench.send(C.TTY2, b"PP100 ")
    assert written == [b"PP100 "]
    port.arrive(b"old")
    bench.send(C.GETAUX, 0)
    bench.send(C.GETAUX, 4)
    port.arrive(b"* P")
    assert len(bench.packets()) == 1
    port.arrive(b"100")
    assert decode_aux(bench.packets()[1]) == (1, b"* P1")
    bench.send(C.GETAUX, 2)
    assert decode_aux(bench.packets()[1]) == (1, b"00")
