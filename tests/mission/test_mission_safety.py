"""Every hazard, and what is then sent to the base."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from safety_robot import DISC, RECTANGLE, REST, TICK, Body, Layer, square

from zavis_bt.mission import SafetySettings
from zavis_bt.types import Twist2D

twists = st.builds(Twist2D, st.floats(-2, 2), st.floats(-4, 4))
AHEAD = (2.0, -3.0, 2.0, 3.0)


def moving(body: Body, speed: float = 0.5, **settings: float) -> Layer:
    """A base that has got to its speed."""
    layer = Layer(body, **settings)
    for _ in range(12):
        layer.tick(Twist2D(speed, 0.0))
    assert body.twist.linear == pytest.approx(speed)
    return layer


def is_motion(sent: Twist2D | str) -> bool:
    return sent not in ("stop", REST)


# -- no hazard -------------------------------------------------------------------------------------------------------


@given(asked=twists)
@settings(deadline=None)  # compiles at first
def test_with_nothing_around_a_twist_within_the_limits_is_passed_on_unchanged(asked):
    limits = Body().spec.limits
    within = Twist2D(
        min(max(asked.linear, -limits.max_reverse), limits.max_linear),
        min(max(asked.angular, -limits.max_angular), limits.max_angular),
    )
    layer = Layer(Body())
    assert layer.tick(asked) == [within]
    assert layer.robot.base.reason == ""


@pytest.mark.parametrize("twist", [Twist2D(math.nan, 0.0), Twist2D(0.0, math.inf)])
def test_a_twist_that_is_not_finite_is_refused_where_it_is_asked_for(twist):
    layer = Layer(Body())
    with pytest.raises(ValueError, match="is not a velocity"):
        layer.tick(twist)
    assert layer.body.sent == []


def test_a_tick_in_which_nobody_asks_slows_down_gently_until_the_base_stands():
    layer = moving(Body())
    ticks = 0
    while layer.body.twist != REST:
        assert layer.tick(None) == [REST]
        ticks += 1
    assert ticks == pytest.approx(0.5 / 0.8 / TICK, abs=1)
    layer.tick(None)
    assert layer.tick(None) == []


def test_the_latest_request_of_a_tick_counts():
    layer = Layer(Body())
    layer.robot.base.command(Twist2D(0.5, 0.5))
    assert layer.tick(Twist2D(0.1, 0.0)) == [Twist2D(0.1, 0.0)]


def test_a_stop_is_passed_on_at_once_and_takes_back_what_was_asked_for():
    layer = moving(Body())
    layer.robot.base.command(Twist2D(0.5, 0.0))
    layer.robot.base.stop()
    assert layer.body.sent[-1] == "stop"
    assert layer.tick(None) == []


# -- reasons to stop as fast as possible ------------------------------------------------------------------------------

HAZARDS = {
    "emergency stop": ({"estop": True}, "emergency stop"),
    "fault": ({"fault": "motors are off (press the motor button)"}, "motors are off (press the motor button)"),
}


@pytest.mark.parametrize("name", HAZARDS)
def test_a_base_that_cannot_drive_is_stopped_hard_and_told_nothing_more(name):
    says, reason = HAZARDS[name]
    layer = moving(Body())
    layer.body.says = says
    assert layer.tick(Twist2D(0.5, 0.5)) == ["stop"]
    assert layer.robot.base.reason == reason
    assert [sent for _ in range(5) for sent in layer.tick(Twist2D(0.5, 0.5))] == []
    layer.body.says = {}
    assert layer.tick(Twist2D(0.2, 0.0)) == [Twist2D(0.2, 0.0)]


@pytest.mark.parametrize(
    ("device", "reason"), [("lidar", "no recent LiDAR scan"), ("base", "the base is not heard of")]
)
def test_a_silent_device_stops_the_base_hard_when_its_age_limit_is_over(device, reason):
    layer = moving(Body())
    layer.body.silent = {device}
    silent_for = 0.0
    while "stop" not in layer.tick(Twist2D(0.5, 0.0)):
        silent_for += TICK
    assert silent_for <= SafetySettings().scan_timeout + TICK
    assert layer.robot.base.reason == reason
    assert not any(is_motion(sent) for _ in range(5) for sent in layer.tick(Twist2D(0.5, 0.0)))
    layer.body.silent = set()
    layer.body.hear()
    assert layer.tick(Twist2D(0.2, 0.0)) == [Twist2D(0.2, 0.0)]


def test_without_any_scan_nothing_moves():
    body = Body()
    body.lidar.works = False
    assert Layer(body).tick(Twist2D(0.5, 0.0)) == []


def test_an_old_scan_is_young_enough_for_a_slow_lidar():
    layer = Layer(Body(), scan_timeout=0.1)  # 10 Hz: 2.5 periods
    layer.body.silent = {"lidar"}
    assert all(layer.tick(Twist2D(0.1, 0.0)) for _ in range(3))
    assert layer.tick(Twist2D(0.1, 0.0)) == ["stop"]


def test_the_stop_is_repeated_while_the_base_still_moves():
    layer = moving(Body())
    layer.body.says = {"estop": True, "twist": Twist2D(0.3, 0.0)}
    assert [layer.tick(None) for _ in range(3)] == [["stop"]] * 3


# -- contact ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("switch", ["bumper", "stalled"])
def test_contact_stops_hard_and_then_allows_only_creeping_away(switch):
    layer = moving(Body())
    layer.body.says = {switch: True}
    assert layer.tick(Twist2D(0.5, 0.0)) == ["stop"]
    assert layer.tick(Twist2D(0.5, 0.0)) == [REST]
    assert layer.tick(Twist2D(-0.5, 0.0)) == [Twist2D(-0.1, 0.0)]
    layer.body.says = {}
    assert layer.tick(Twist2D(0.5, 0.0)) == [Twist2D(0.5, 0.0)]


def test_contact_in_reverse_allows_only_creeping_forward():
    layer = moving(Body(), speed=-0.3)
    layer.body.says = {"bumper": True}
    layer.tick(Twist2D(-0.3, 0.0))
    assert layer.tick(Twist2D(-0.3, 0.0)) == [REST]
    assert layer.tick(Twist2D(0.3, 0.0)) == [Twist2D(0.1, 0.0)]


def test_with_contact_no_part_of_the_outline_turns_faster_than_creep():
    body = Body(RECTANGLE)
    body.says = {"stalled": True}
    layer = Layer(body)
    layer.tick(None)
    ((turn),) = layer.tick(Twist2D(0.0, -1.5))
    assert turn == Twist2D(0.0, pytest.approx(-0.1 / RECTANGLE.circumscribed_radius))


def test_creeping_away_minds_obstacles_too():
    body = Body(walls=[(-0.19, -1.0, -0.19, 1.0)])
    body.says = {"bumper": True}
    layer = Layer(body)
    layer.tick(Twist2D(-0.1, 0.0))
    assert layer.tick(Twist2D(-0.1, 0.0)) == [REST]


# -- battery, pace ----------------------------------------------------------------------------------------------------


def test_a_flat_battery_slows_down_gently():
    layer = moving(Body())
    layer.body.says = {"battery": 0.04}
    assert layer.tick(Twist2D(0.5, 0.5)) == [REST]
    assert layer.robot.base.reason == "battery at 4%"


def test_a_tick_that_took_too_long_is_not_followed_by_motion():
    layer = moving(Body())
    layer.body.advance(0.4)
    assert layer.tick(Twist2D(0.5, 0.0)) == [REST]
    assert layer.robot.base.reason == "a tick took 0.5 s"
    assert layer.tick(Twist2D(0.5, 0.0)) == [Twist2D(0.5, 0.0)]


def test_ticks_that_keep_taking_too_long_leave_only_creeping_and_the_journal_says_so():
    layer = moving(Body())
    for _ in range(3):
        layer.body.advance(0.4)
        layer.tick(Twist2D(0.5, 0.0))
    assert layer.tick(Twist2D(0.5, 0.2)) == [Twist2D(pytest.approx(0.1), pytest.approx(0.04))]
    assert layer.reasons[-1] == "ticks take too long"
    for _ in range(20):
        layer.tick(Twist2D(0.1, 0.0))
    assert layer.tick(Twist2D(0.5, 0.0)) == [Twist2D(0.5, 0.0)]


def test_slower_ticks_need_more_room_to_brake():
    allowed = []
    for seconds in (TICK, 0.28):
        body = Body(walls=[(0.45, -3.0, 0.45, 3.0)])
        layer = Layer(body)
        for _ in range(3):
            layer.tick(Twist2D(0.0, 0.0), seconds)
        (sent,) = layer.tick(Twist2D(0.7, 0.0), 0)
        allowed.append(sent.linear)
    assert 0 < allowed[1] < allowed[0] < 0.7


# -- what the base raises ---------------------------------------------------------------------------------------------


def test_what_the_base_raises_is_kept_and_ends_in_a_stop():
    layer = Layer(Body())
    layer.body.broken = {"base"}
    assert layer.tick(Twist2D(0.5, 0.0)) == ["stop"]
    assert layer.robot.base.trouble == "base: /dev/ttyUSB0 is gone (plug it in)"
    layer.body.broken = set()
    assert layer.tick(Twist2D(0.5, 0.0)) == [Twist2D(0.5, 0.0)]
    assert layer.robot.base.trouble == ""


def test_a_halted_robot_is_told_nothing_until_it_may_go_on():
    layer = moving(Body())
    layer.robot.halt()
    assert layer.body.sent[-1] == "stop"
    assert layer.body.moves == ["stop"]
    assert [sent for _ in range(3) for sent in layer.tick(Twist2D(0.5, 0.0))] == []
    layer.robot.resume()
    assert layer.tick(Twist2D(0.5, 0.0)) == [Twist2D(0.5, 0.0)]


def test_halting_stops_the_pan_tilt_unit_even_if_the_base_breaks_its_promise(caplog, monkeypatch):
    layer = moving(Body())
    monkeypatch.setattr(layer.body.base, "stop", lambda: 1 / 0)
    layer.robot.halt()
    assert layer.body.moves == ["stop"]
    assert "ZeroDivisionError" in caplog.text


def test_the_journal_tells_each_reason_once():
    body = Body(walls=[(0.19, -1.0, 0.19, 1.0)])
    layer = Layer(body)
    for _ in range(5):
        layer.tick(Twist2D(0.5, 0.0))
    assert layer.reasons == ["obstacle ahead"]
    assert layer.journal.counts["safety"] == 1


# -- whatever is asked for --------------------------------------------------------------------------------------------

DANGERS = [
    {"says": {"estop": True}},
    {"says": {"fault": "link lost"}},
    {"says": {"battery": 0.01}},
    {"silent": {"lidar"}},
    {"silent": {"base"}},
    {"broken": {"base"}},
]


@pytest.mark.parametrize("danger", DANGERS, ids=str)
@given(asked=st.lists(st.none() | twists, min_size=6, max_size=10), footprint=st.sampled_from([DISC, RECTANGLE]))
@settings(max_examples=10, deadline=None)
def test_no_motion_is_sent_while_a_hazard_holds(danger, asked, footprint):
    layer = Layer(Body(footprint, square(2.0)))
    for twist in asked[:3]:
        layer.tick(twist)
    for name, value in danger.items():
        setattr(layer.body, name, value)
    for _ in range(3):  # silence takes until its age limit to be one
        layer.tick(None)
    assert not any(is_motion(sent) for twist in asked[3:] for sent in layer.tick(twist))
