from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from arcos_bench import CENTRE, HALL, STEP, Bench, raw
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.pioneer.codec import (
    CommandNumber,
    Flags,
    PacketType,
    decode_aux,
    decode_config,
    decode_encoders,
    decode_identity,
    encode_sync,
)
from sim.devices.arcos import P3AT, P3DX, Phase
from sim.kinematics import Motion
from sim.world import World
from zavis_bt.types import Pose2D

C = CommandNumber


@pytest.fixture
def bench() -> Bench:
    return Bench(HALL, CENTRE)


@pytest.fixture
def fresh() -> Bench:
    return Bench(HALL, CENTRE, connected=False)


def test_the_first_two_syncs_are_echoed_and_the_third_tells_the_name(fresh: Bench) -> None:
    assert [fresh.packet(encode_sync(number)).packets for number in (0, 1)] == [encode_sync(0), encode_sync(1)]
    reply = fresh.packet(encode_sync(2)).packets
    assert reply.hex(" ").upper() == (
        "FA FB 1C 02 73 69 6D 72 6F 62 6F 74 00 50 69 6F 6E 65 65 72 00 70 33 61 74 2D 73 68 00 B3 14"
    )
    assert fresh.firmware.phase is Phase.OPEN


@pytest.mark.parametrize("order", [[1], [2], [0, 2], [0, 1, 1]])
def test_a_sync_out_of_order_is_not_answered_and_begins_anew(fresh: Bench, order: list[int]) -> None:
    replies = [fresh.packet(encode_sync(number)).packets for number in order]
    assert replies[-1] == b""
    assert fresh.firmware.phase is Phase.SYNC0
    fresh.connect()
    assert fresh.packets()


def test_sync0_may_come_again_at_any_time_of_the_handshake(fresh: Bench) -> None:
    assert [fresh.packet(encode_sync(number)).packets for number in (0, 0, 1, 0, 1)] == [
        encode_sync(number) for number in (0, 0, 1, 0, 1)
    ]


@pytest.mark.parametrize("number", [C.OPEN, C.ENABLE, C.BATTERYINFO, 200])
def test_commands_with_an_argument_do_not_disturb_the_handshake(fresh: Bench, number: int) -> None:
    fresh.packet(encode_sync(0))
    assert fresh.send(number, 1) == (b"", False)
    assert fresh.packet(encode_sync(1)).packets == encode_sync(1)


def test_close_during_the_handshake_begins_anew(fresh: Bench) -> None:
    fresh.packet(encode_sync(0))
    assert fresh.send(C.CLOSE, 1) == (b"", False)
    assert fresh.firmware.phase is Phase.SYNC0


def test_the_robot_says_nothing_unasked_before_open(fresh: Bench) -> None:
    for number in range(3):
        fresh.packet(encode_sync(number))
    assert fresh.firmware.report() == b""
    assert fresh.send(C.PULSE).packets == b""
    assert decode_config(fresh.send(C.CONFIG).packets[3:-2]).subclass == "p3at-sh"
    fresh.packet(encode_sync(1))  # which is OPEN by now
    assert fresh.packets()[0][0] == PacketType.STANDING


def test_after_the_handshake_the_numbers_of_syncs_are_commands(bench: Bench) -> None:
    assert bench.packet(encode_sync(0)).packets == b""
    assert bench.packet(encode_sync(2)).closed
    assert bench.firmware.phase is Phase.SYNC0


@pytest.mark.parametrize("number", [C.CLOSE, C.RESET])
def test_close_stops_the_robot_and_restores_the_stored_settings(bench: Bench, number: int) -> None:
    for command, value in ((C.SETV, 300), (C.SETA, 900), (C.SETRA, -40), (C.SONAR, 0), (C.BATTEST, 115), (C.VEL, 300)):
        bench.send(command, value)
    bench.run(1.5)
    assert bench.send(number).closed
    for _ in range(10):
        bench.plant.step()
    assert bench.plant.motion.linear == 0.0
    bench.connect()
    sip = bench.sip()
    assert sip.flags == Flags.SONAR_1 | Flags.SONAR_2
    assert (sip.x, sip.y, sip.heading, sip.battery) == (0, 0, 0, 130)
    assert config(bench) == replace(P3AT.config, watchdog=1000)


def config(bench: Bench) -> object:
    return decode_config(bench.send(C.CONFIG, 1).packets[3:-2])


def test_the_configuration_tells_the_bounds_in_force(bench: Bench) -> None:
    figures = ((C.SETV, 500), (C.SETA, 400), (C.SETA, -600), (C.SETRV, 9999), (C.SETRA, 70), (C.SETRA, -80))
    for command, value in figures:
        bench.send(command, value)
    expected = replace(
        P3AT.config,
        watchdog=1000,
        velocity_max=500,
        acceleration=400,
        deceleration=600,
        rotation_velocity_max=300,
        rotation_acceleration=70,
        rotation_deceleration=80,
    )
    assert config(bench) == expected


def test_another_kind_of_pioneer_introduces_itself() -> None:
    bench = Bench(HALL, CENTRE, model=P3DX, connected=False)
    for number in range(3):
        reply = bench.packet(encode_sync(number)).packets
    assert decode_identity(reply[3:-2]).subclass == "p3dx-sh"


@pytest.mark.parametrize("number", [C.VEL, C.RVEL, C.ROTATE, C.MOVE, C.HEAD, C.DHEAD, C.DCHEAD, C.VEL2])
def test_nothing_moves_the_robot_until_the_motors_are_on(number: int) -> None:
    bench = Bench(HALL, CENTRE, motors=False)
    bench.send(number, 30)
    bench.run(0.4)
    bench.send(C.ENABLE, 1)
    assert bench.run(0.4)[-1].true == (0.0, 0.0, 0.0)
    bench.send(number, 30)
    assert bench.run(0.4)[-1].true != (0.0, 0.0, 0.0)
    bench.send(C.ENABLE, 0)
    motions = bench.run(0.8)
    assert motions[-1].true == motions[20].true
    assert not bench.sip().flags & Flags.MOTORS_ENABLED


def test_a_robot_that_is_no_longer_heard_of_stops_and_stays_connected(bench: Bench) -> None:
    bench.send(C.VEL, 300)
    bench.send(C.RVEL, 40)
    bench.run(2.0)
    silent = bench.run(2.5, pulse=False)
    moving = [motion.linear == pytest.approx(0.3) for motion in silent]
    assert 0.8 <= moving.index(False) * STEP <= 1.1
    assert silent[-1].linear == silent[-1].angular == 0.0
    assert bench.sip().flags & Flags.MOTORS_ENABLED
    assert bench.run(1.0)[-1].true == silent[-1].true  # PULSE alone does not set it going
    bench.send(C.VEL, 300)
    assert bench.run(1.5)[-1].linear == pytest.approx(0.3)


@pytest.mark.parametrize(("watchdog", "way"), [(0.0, 1.8), (0.3, 0.3)])
def test_the_watchdogs_time_can_be_chosen_or_none(watchdog: float, way: float) -> None:
    bench = Bench(HALL, CENTRE, watchdog=watchdog)
    assert config(bench).watchdog == watchdog * 1000
    bench.send(C.SETA, 4000)
    bench.send(C.SETA, -4000)
    bench.send(C.MOVE, 1800)
    assert bench.run(6.0, pulse=False)[-1].true.x == pytest.approx(way, rel=0.6 if watchdog else 1e-3)


def test_a_move_survives_pulses_and_ends_with_the_watchdog(bench: Bench) -> None:
    bench.send(C.MOVE, 4000)
    bench.run(2.0)
    assert bench.run(5.0, pulse=False)[-1].true.x < 2.5


@pytest.mark.parametrize("packet", [raw(C.SETO), raw(C.SETO, 0x3B), raw(C.SETO, 0x3B, 0, 0)])
def test_seto_puts_the_odometry_to_zero_in_all_its_forms(bench: Bench, packet: bytes) -> None:
    bench.send(C.VEL, 300)
    bench.send(C.RVEL, 20)
    bench.run(3.0)
    bench.send(C.STOP)
    bench.run(2.0)
    assert bench.sip().x > 300
    bench.packet(packet)
    assert bench.sip()[1:4] == (0, 0, 0)


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


def test_the_stop_button_cuts_the_motors_until_they_are_switched_on_again(bench: Bench) -> None:
    bench.send(C.VEL, 500)
    bench.run(2.0)
    bench.plant.estop = True
    pressed = bench.run(0.4)
    assert pressed[-1].linear == 0.0
    assert bench.sip().flags & 0x7F == Flags.STOP_PRESSED | Flags.E_STALL | Flags.SONAR_1 | Flags.SONAR_2
    bench.send(C.ENABLE, 1)
    bench.send(C.VEL, 500)
    assert bench.run(0.4)[-1].true == pressed[-1].true
    bench.plant.estop = False
    bench.send(C.VEL, 500)
    assert bench.run(0.4)[-1].true == pressed[-1].true
    assert not bench.sip().flags & (Flags.MOTORS_ENABLED | Flags.STOP_PRESSED)
    bench.send(C.ENABLE, 1)
    bench.send(C.VEL, 500)
    assert bench.run(0.4)[-1].linear > 0.1
    assert bench.sip().flags & 0x7F == Flags.MOTORS_ENABLED | Flags.SONAR_1 | Flags.SONAR_2


def test_the_stop_button_need_not_count_as_a_stall(bench: Bench) -> None:
    bench.send(C.E_STALL, 0)
    bench.plant.estop = True
    bench.run(0.1)
    assert not bench.sip().flags & (Flags.E_STALL | Flags.MOTORS_ENABLED)


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


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.binary(min_size=1, max_size=12), st.integers(0, 5)), max_size=25))
def test_no_payload_whatsoever_upsets_the_firmware(payloads: list[tuple[bytes, int]]) -> None:
    bench = Bench(HALL, CENTRE)
    before: Motion = bench.plant.motion
    for payload, steps in payloads:
        bench.firmware.receive(payload)
        bench.firmware.report()
        for _ in range(steps):
            bench.plant.step()
            after = bench.plant.motion
            assert abs(after.linear - before.linear) <= 4.0 * STEP + 1e-9
            assert abs(after.angular - before.angular) <= math.radians(600) * STEP + 1e-9
            before = after
