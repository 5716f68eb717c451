"""The pose goes on, whatever the counters do."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.pioneer.codec import ANGLE_STEPS, Encoders, Sip
from drivers.pioneer.models import Parameters, parameters_of
from drivers.pioneer.odometry import Odometry, twist_of
from zavis_bt.types import Pose2D

P3AT = parameters_of("p3at-sh")
START = Pose2D(3.0, -2.0, 0.5)


def drive(odometry: Odometry, counters: list[tuple[int, int, int]], parameters: Parameters = P3AT) -> Pose2D:
    """Let the counters run, wrapped at 16 bits, a tenth of a second each."""
    for i, (x, y, heading) in enumerate(counters):
        turned = (heading + 2048) % 4096 - 2048
        odometry.update(Sip(x=x % 65536, y=y % 65536, heading=turned), i / 10, parameters)
    return odometry.pose


def test_the_first_packet_is_the_zero() -> None:
    assert drive(Odometry(START), [(12345, -999, 1000)]) == START


@pytest.mark.parametrize("bits", [15, 16])
def test_a_straight_way_has_its_length_wherever_the_counters_wrap(bits: int) -> None:
    ways = [(x % (1 << bits), 0, 0) for x in range(32000, 70000, 50)]
    pose = drive(Odometry(Pose2D(0.0, 0.0)), ways)
    assert pose.x == pytest.approx(37.95)
    assert pose.y == 0


@given(st.integers(0, 65535), st.integers(0, 65535), st.integers(-2048, 2047), st.integers(-40, 40))
def test_driving_and_turning_back_ends_where_it_began(x: int, y: int, heading: int, turn: int) -> None:
    there = [(x + 30 * i, y - 20 * i, heading + turn * i) for i in range(60)]
    odometry = Odometry(START)
    pose = drive(odometry, there + there[::-1])
    assert pose.distance(START) < 1e-9
    assert math.remainder(pose.yaw - START.yaw, math.tau) == pytest.approx(0, abs=1e-9)
    assert odometry.jumps == 0


@given(st.integers(-2048, 2047), st.floats(-math.pi, math.pi))
def test_forward_is_forward_in_the_map_whatever_the_robot_takes_for_its_heading(heading: int, yaw: float) -> None:
    angle = heading * math.tau / ANGLE_STEPS
    ways = [(round(50 * i * math.cos(angle)), round(50 * i * math.sin(angle)), heading) for i in range(100)]
    pose = drive(Odometry(Pose2D(0.0, 0.0, yaw)), ways)
    assert pose.x == pytest.approx(4.95 * math.cos(yaw), abs=0.003)
    assert pose.y == pytest.approx(4.95 * math.sin(yaw), abs=0.003)


def test_a_full_turn_is_a_full_turn() -> None:
    odometry = Odometry(Pose2D(0.0, 0.0))
    yaws = [drive_one(odometry, 16 * i, i) for i in range(257)]
    assert yaws[64] == pytest.approx(math.pi / 2)
    assert yaws[256] == pytest.approx(0, abs=1e-9)


def drive_one(odometry: Odometry, heading: int, i: int) -> float:
    return odometry.update(Sip(heading=(heading + 2048) % 4096 - 2048), i / 10, P3AT).yaw


def test_a_jump_of_the_counters_moves_nothing_and_is_counted() -> None:
    odometry = Odometry(START)
    drive(odometry, [(0, 0, 0), (5000, 0, 0), (5000, 0, 0)])
    assert (odometry.pose, odometry.jumps) == (START, 1)


TICKS = 138


def ticks(way: float, turn: float) -> Encoders:
    """What the encoders of a robot count that has driven so far and turned so much [m, rad]."""
    half = turn / P3AT.difference_factor
    return Encoders(round((way * 1000 - half) * TICKS), round((way * 1000 + half) * TICKS))


@given(st.floats(-0.5, 0.5), st.floats(-8, 8), st.integers(-(1 << 31), (1 << 31) - 1))
def test_what_happened_while_the_link_was_lost_is_known_from_the_encoders(way: float, turn: float, first: int) -> None:
    odometry, moved = Odometry(START), ticks(way, turn)
    odometry.update(Sip(x=500, heading=77), 0.0, P3AT)
    odometry.bridge(Encoders(first, -1), 0.0, P3AT, TICKS)
    odometry.resume()
    odometry.update(Sip(), 2.0, P3AT)
    assert not odometry.settled
    wrapped = (first + moved.left + (1 << 31)) % (1 << 32) - (1 << 31)
    odometry.bridge(Encoders(wrapped, moved.right - 1), 2.0, P3AT, TICKS)
    chord = way * math.sin(turn / 2) / (turn / 2) if abs(turn) > 1e-9 else way
    towards = START.yaw + turn / 2
    assert odometry.settled
    assert odometry.pose.x == pytest.approx(START.x + chord * math.cos(towards), abs=1e-4)
    assert odometry.pose.y == pytest.approx(START.y + chord * math.sin(towards), abs=1e-4)
    assert math.remainder(odometry.pose.yaw - START.yaw - turn, math.tau) == pytest.approx(0, abs=1e-4)


def test_a_new_connection_begins_where_the_old_one_ended_if_the_encoders_tell_nothing() -> None:
    for packet in (None, Encoders(0, 0), Encoders(10**9, -(10**9))):  # none, switched off in between, impossible
        odometry = Odometry(Pose2D(0.0, 0.0))
        odometry.update(Sip(x=1000, heading=500), 0.0, P3AT)
        before = odometry.update(Sip(x=1050, heading=600), 0.1, P3AT)
        odometry.bridge(Encoders(7000, 8000), 0.1, P3AT, TICKS)
        odometry.resume()
        assert odometry.update(Sip(), 2.0, P3AT) == before
        if packet:
            odometry.bridge(packet, 2.0, P3AT, TICKS)
        for i in range(6):
            odometry.update(Sip(heading=10), 2.1 + i / 10, P3AT)
        assert odometry.settled
        assert odometry.pose.yaw == pytest.approx(before.yaw + 10 * math.tau / ANGLE_STEPS)
        assert odometry.pose.distance(before) == 0


def test_encoders_change_nothing_while_the_link_holds() -> None:
    odometry = Odometry(START)
    odometry.update(Sip(), 0.0, P3AT)
    odometry.bridge(ticks(0, 0), 0.0, P3AT, TICKS)
    odometry.bridge(ticks(0.1, 0.1), 0.1, P3AT, TICKS)
    assert odometry.pose == START
    assert odometry.settled


@given(st.floats(-1, 1), st.floats(-2, 2))
def test_the_velocity_is_the_same_from_the_wheels_as_from_the_robot(linear: float, angular: float) -> None:
    half = angular / P3AT.difference_factor
    wheels = Sip(left_velocity=round(linear * 1000 - half), right_velocity=round(linear * 1000 + half))
    told = wheels._replace(rotational_velocity=round(math.degrees(angular) * 10))
    for sip in (wheels._replace(rotational_velocity=None), told):
        twist = twist_of(sip, P3AT)
        assert twist.linear == pytest.approx(linear, abs=0.0011)
        assert twist.angular == pytest.approx(angular, abs=0.004)


@pytest.mark.parametrize(
    ("subclass", "family", "factor"),
    [
        ("p3at-sh", "p3at", 1.0),
        ("P3AT-SH", "p3at", 1.0),
        ("p3atiw-sh", "p3at", 1.0),
        ("p3at", "p3at", 0.465),
        ("p3dx-sh-lms1xx", "p3dx", 1.0),
        ("p3dx", "p3dx", 0.485),
    ],
)
def test_the_subclass_chooses_the_parameters(subclass: str, family: str, factor: float) -> None:
    parameters = parameters_of(subclass)
    assert (parameters.family, parameters.distance_factor, parameters.known) == (family, factor, True)
    assert parameters.length > parameters.width > 0
    assert len(parameters.sonar) == 16


def test_an_unknown_subclass_is_taken_as_a_p3at_and_says_so() -> None:
    assert (parameters_of("amigo").family, parameters_of("amigo").known) == ("p3at", False)


def test_sonar_rings_are_symmetric() -> None:
    for subclass in ("p3at-sh", "p3dx-sh"):
        ring = parameters_of(subclass).sonar
        assert {(x, -y, (-angle) % 360) for x, y, angle in ring} == {(x, y, angle % 360) for x, y, angle in ring}


def test_the_track_is_the_effective_one_of_a_skidding_robot() -> None:
    assert P3AT.track == pytest.approx(0.588, abs=0.001)
