from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scip_host import START, StillSensor

from drivers.lidar.codec import AnswerDecoder, decode_information, decode_number
from sim.devices.scip_eye import NO_ECHO, TOO_NEAR
from sim.simulation import Simulation


@pytest.fixture
def still(room, spec) -> StillSensor:
    return StillSensor(room, spec)


def ranges_of(data: bytes) -> list[np.ndarray]:
    return [answer.readings.ranges for answer in AnswerDecoder().feed(data) if answer.readings is not None]


def test_the_scan_is_the_worlds(still, room, spec):
    still.say(b"BM")
    seen = still.ask(b"GD0000018000").readings.ranges
    expected = Simulation(room, spec, START).robot.lidar.scan().ranges
    assert np.abs(seen - expected * 1000).max() <= 0.51


def test_what_is_too_far_and_too_near_has_its_code(room, spec):
    short = dataclasses.replace(spec, lidar=dataclasses.replace(spec.lidar, range_min=1.2, range_max=2.0))
    still = StillSensor(room, short)
    still.say(b"BM")
    seen = still.ask(b"GD0000018000").readings.ranges
    expected = Simulation(room, short, START).robot.lidar.scan().ranges
    assert ((seen == NO_ECHO) == np.isinf(expected)).all()
    assert ((seen == TOO_NEAR) == np.isnan(expected)).all()
    assert {NO_ECHO, TOO_NEAR} < set(seen.tolist())


def test_information_has_all_that_hosts_look_for(still):
    assert still.say(b"PP").count(b"\n") >= 10
    assert still.say(b"VV").count(b"\n") >= 7
    assert still.say(b"II").count(b"\n") >= 9
    told = decode_information(still.ask(b"PP").lines)
    assert list(told) == ["MODL", "DMIN", "DMAX", "ARES", "AMIN", "AMAX", "AFRT", "SCAN"]
    assert len(told["MODL"]) >= 8
    assert list(decode_information(still.ask(b"VV").lines)) == ["VEND", "PROD", "FIRM", "PROT", "SERI"]
    keys = ["MODL", "LASR", "SCSP", "MESM", "SBPS", "TIME", "STAT"]
    assert list(decode_information(still.ask(b"II").lines)) == keys


def test_the_echo_comes_back_with_its_text(still):
    assert still.say(b"BM;Ab 1!") == b"BM;Ab 1!\n00P\n\n"


def test_lines_end_with_lf_or_cr_and_empty_ones_have_no_answer(still):
    assert still.sensor.hear(b"\n\r\n\r") == b""
    assert still.sensor.hear(b"Q") == b""
    assert still.sensor.hear(b"T\rQT\r\nQT\n") == 3 * b"QT\n00P\n\n"


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        (b"XY", b"0Ee"),
        (b"GD00", b"0Cc"),
        (b"QT1", b"0Dd"),
        (b"QT;12345678901234567", b"0Gg"),
        (b"QT;\x07", b"0Hh"),
        (b"GDabcd000001", b"01Q"),
        (b"GD0000abcd01", b"02R"),
        (b"GD00000001ab", b"03S"),
        (b"GD0000018100", b"04T"),
        (b"GD0002000100", b"05U"),
        (b"SS019200", b"0Ff"),
        (b"SCIP2.0", b"0Ee"),
        (b"TM7", b"01Q"),
        (b"HS7", b"01Q"),
        (b"CR55", b"01Q"),
        (b"MD000000010ax01", b"03S"),
    ],
)
def test_bad_requests_are_answered_with_their_status(still, request_, status):
    still.say(b"BM")
    assert still.say(request_) == request_ + b"\n" + status + b"\n\n"


def test_a_line_without_end_does_not_fill_the_memory(still):
    for _ in range(100):
        assert still.sensor.hear(b"x" * 1000) == b""
    assert len(still.sensor.hear(b"\n")) < 200


def test_single_scans_need_the_laser(still):
    assert still.ask(b"GD0000000201").status == "10"
    assert still.ask(b"BM").status == "00"
    assert still.ask(b"BM").status == "02"
    assert len(still.ask(b"GD0000000201").readings.ranges) == 3
    assert still.ask(b"QT").status == "00"
    assert still.ask(b"GD0000000201").status == "10"


def test_short_and_bright_scans_are_of_the_same_sweep(still):
    still.say(b"BM")
    long, short = still.ask(b"GD0000018000").readings, still.ask(b"GS0000018000").readings
    bright = still.ask(b"GE0000018000").readings
    assert np.array_equal(short.ranges, np.minimum(long.ranges, 4095))
    assert np.array_equal(bright.ranges, long.ranges)
    assert (np.argsort(bright.intensities)[::-1][:1] == np.argmin(bright.ranges)).all()


def test_a_cluster_is_the_smallest_of_its_neighbours(still):
    still.say(b"BM")
    every = still.ask(b"GD0000001001").readings.ranges
    grouped = still.ask(b"GD0000001004").readings.ranges
    assert grouped.tolist() == [every[:4].min(), every[4:8].min(), every[8:].min()]


def test_a_stream_counts_down_and_ends(still):
    assert still.say(b"MD0000000201003") == b"MD0000000201003\n00P\n\n"
    sent = still.turn(9)
    assert [scan.split(b"\n")[:2] for scan in sent] == [[f"MD000000020100{n}".encode(), b"99b"] for n in (2, 1, 0)]
    assert still.ask(b"%ST").lines == (b"000",)


def test_an_endless_stream_keeps_its_echo_and_every_turn_has_a_scan(still):
    still.say(b"ME0000000201000;me")
    sent = still.turn(20)
    assert len(sent) == 20
    assert all(scan.startswith(b"ME0000000201000;me\n99b\n") for scan in sent)
    assert still.ask(b"%ST").lines == (b"004",)


def test_skipped_turns_are_not_sent_and_stamps_show_it(still):
    still.say(b"MD0000000201300")
    clocks = [answer.readings.clock for scan in still.turn(12) for answer in AnswerDecoder().feed(scan)]
    assert len(clocks) == 3
    assert np.diff(clocks) == pytest.approx(400, abs=1)


def test_a_second_stream_replaces_the_first_and_questions_may_come_in_between(still):
    still.say(b"MD0000000201000")
    assert still.ask(b"II").status == "00"
    still.say(b"MS0000000101000")
    assert {scan[:15] for scan in still.turn(3)} == {b"MS0000000101000"}
    still.say(b"QT")
    assert still.turn(3) == []
    assert still.sensor.due is None


def test_a_scan_that_cannot_be_sent_is_left_out_and_not_counted(still):
    still.say(b"MD0000000201002")
    still.now = still.sensor.due
    assert still.sensor.scan(send=False) == b""
    assert [scan[13:15] for scan in still.turn(5)] == [b"01", b"00"]


def test_the_time_mode_tells_the_time_and_keeps_the_laser_off(still):
    assert still.ask(b"TM1").status == "04"
    assert still.ask(b"TM2").status == "03"
    assert [still.ask(b"TM0").status for _ in range(2)] == ["00", "02"]
    first = decode_number(still.ask(b"TM1").lines[0])
    still.now += 1.5
    assert decode_number(still.ask(b"TM1").lines[0]) == first + 1500
    assert still.ask(b"BM").status == "01"
    assert still.ask(b"MD0000000201000").status == "10"
    assert still.ask(b"%ST").lines == (b"002",)
    assert still.ask(b"TM2").status == "00"
    still.say(b"BM")
    assert still.ask(b"TM0").status == "10"


def test_the_clock_begins_again_after_24_bits(still):
    still.say(b"TM0")
    still.now += 1e-4 + (1 << 24) / 1000
    assert decode_number(still.ask(b"TM1").lines[0]) == 0


def test_sensitivity_and_speed_are_kept_until_the_reset(still):
    assert [still.ask(b"HS1").status, still.ask(b"HS1").status, still.ask(b"HS0").status] == ["00", "02", "00"]
    assert [still.ask(b"CR10").status, still.ask(b"CR10").status] == ["00", "02"]
    still.say(b"MD0000000201000")
    assert len(still.turn(100)) == pytest.approx(90, abs=1)
    assert decode_information(still.ask(b"II").lines)["SCSP"] == "540[rpm]"
    assert still.ask(b"RS").status == "00"
    assert still.turn(5) == []
    told = decode_information(still.ask(b"II").lines)
    assert (told["SCSP"], told["LASR"]) == ("600[rpm]", "OFF")


def test_angles_run_counter_clockwise(still):
    still.say(b"BM")
    seen = still.ask(b"GD0000018001").readings.ranges / 1000
    yaw, mount = START.yaw, 0.1
    right, left = (START.x + mount * math.cos(yaw), START.y + mount * math.sin(yaw)), yaw + math.pi / 2
    assert seen[0] == pytest.approx(right[1] / math.cos(yaw), abs=0.001)  # to the wall below
    assert seen[180] == pytest.approx(min((4.0 - right[1]) / math.sin(left), right[0] / -math.cos(left)), abs=0.001)
