from __future__ import annotations

import math
from dataclasses import replace

import pytest
from arcos_bench import CENTRE, HALL, STEP, Bench, raw
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.pioneer.codec import (
    CommandNumber,
    Flags,
    PacketType,
    decode_config,
    decode_identity,
    encode_sync,
)
from sim.devices.arcos import P3AT, P3DX, Phase
from sim.kinematics import Motion

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
