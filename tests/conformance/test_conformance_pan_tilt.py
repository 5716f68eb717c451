"""What every pan-tilt unit must do."""

from __future__ import annotations

import itertools
import math

import pytest
from conformance_rigs import PERIOD, Rig, duration
from conformance_room import MIDDLE

from zavis_bt.types import PanTiltState

START = MIDDLE


def move(rig: Rig, pan: float, tilt: float) -> list[PanTiltState]:
    """Move there; return the states on the way, the last one settled."""
    states: list[PanTiltState] = []

    def arrived() -> bool:
        states.append(rig.robot.pan_tilt.state())
        return states[-1].settled

    rig.robot.pan_tilt.move_to(pan, tilt)
    assert rig.wait_for(arrived)
    return states


@pytest.fixture(autouse=True)
def level(rig: Rig) -> None:
    move(rig, 0.0, 0.0)


def test_it_is_well_and_rests_within_its_limits(rig: Rig) -> None:
    spec, state = rig.robot.spec.pan_tilt, rig.robot.pan_tilt.state()
    assert (state.fault, state.settled) == ("", True)
    assert spec.pan_min <= state.pan <= spec.pan_max
    assert spec.tilt_min <= state.tilt <= spec.tilt_max
    rig.run(0.2)
    assert rig.robot.pan_tilt.state().pan == pytest.approx(state.pan, abs=rig.angle_error)


@pytest.mark.parametrize(("pan", "tilt"), [(1.0, 0.5), (-1.0, -0.5), (0.0, 0.5)])
def test_both_axes_come_to_rest_at_their_targets(rig: Rig, pan: float, tilt: float) -> None:
    pan, tilt = pan * rig.sweep, tilt * rig.sweep
    state = move(rig, pan, tilt)[-1]
    assert (state.pan, state.tilt) == pytest.approx((pan, tilt), abs=rig.angle_error)
    rig.run(0.15)
    state = rig.robot.pan_tilt.state()
    assert (state.pan, state.tilt) == pytest.approx((pan, tilt), abs=rig.angle_error)


def test_it_is_settled_only_at_the_target(rig: Rig) -> None:
    states = move(rig, rig.sweep, -rig.sweep / 2)
    assert not states[0].settled
    for state in states:
        if state.settled:
            assert (state.pan, state.tilt) == pytest.approx((rig.sweep, -rig.sweep / 2), abs=rig.angle_error)


def test_it_keeps_to_its_rate(rig: Rig) -> None:
    spec = rig.robot.spec.pan_tilt
    rig.robot.pan_tilt.move_to(rig.sweep, rig.sweep / 2)
    assert rig.wait_for(rig.settled)
    end = rig.robot.pan_tilt.state().stamp
    angles = [rig.robot.pan_tilt.angles_at(end - 0.8 + 0.05 * step) for step in range(17)]
    for one, two in itertools.pairwise(angles):
        assert math.dist(one, two) <= math.sqrt(2) * 1.1 * spec.max_rate * (0.05 + rig.slack) + 2 * rig.angle_error


def test_targets_are_clipped_to_the_limits(rig: Rig) -> None:
    rig.only_simulated("would move to both ends")
    spec = rig.robot.spec.pan_tilt
    for pan, tilt in ((9.0, -9.0), (-9.0, 9.0)):
        state = move(rig, pan, tilt)[-1]
        expected = (spec.pan_max, spec.tilt_min) if pan > 0 else (spec.pan_min, spec.tilt_max)
        assert (state.pan, state.tilt) == pytest.approx(expected, abs=rig.angle_error)


def test_a_stop_on_the_way_ends_it_there(rig: Rig) -> None:
    unit, target = rig.robot.pan_tilt, 2 * rig.sweep
    unit.move_to(target, rig.sweep / 2)
    assert rig.wait_for(lambda: unit.state().pan > 0.05 * target)
    unit.stop()
    unit.stop()
    assert rig.wait_for(rig.settled)
    rig.run(0.1)
    state = unit.state()
    # Acceleration and jerk are bounded, so that it comes to rest some way on.
    assert 0.05 * target < state.pan < 0.85 * target
    rig.run(0.2)
    assert unit.state().pan == pytest.approx(state.pan, abs=rig.angle_error)
    assert move(rig, 0.0, 0.0)[-1].pan == pytest.approx(0.0, abs=rig.angle_error)


def test_a_stop_at_rest_changes_nothing(rig: Rig) -> None:
    before = move(rig, rig.sweep / 2, 0.0)[-1]
    rig.robot.pan_tilt.stop()
    rig.run(0.2)
    after = rig.robot.pan_tilt.state()
    assert (after.pan, after.tilt) == pytest.approx((before.pan, before.tilt), abs=rig.angle_error)
    assert rig.wait_for(rig.settled)


def test_a_new_target_on_the_way_takes_over(rig: Rig) -> None:
    rig.robot.pan_tilt.move_to(rig.sweep, 0.2)
    rig.run(0.1)
    state = move(rig, -rig.sweep / 2, -0.2)[-1]
    assert (state.pan, state.tilt) == pytest.approx((-rig.sweep / 2, -0.2), abs=rig.angle_error)


def test_the_same_target_again_and_again_does_not_hold_it_up(rig: Rig) -> None:
    begin = rig.clock.now()

    def arrived() -> bool:
        rig.robot.pan_tilt.move_to(rig.sweep, 0.0)
        return rig.clock.now() > begin + 0.3 and rig.settled()

    assert rig.wait_for(arrived, PERIOD / 2)
    assert rig.robot.pan_tilt.state().pan == pytest.approx(rig.sweep, abs=rig.angle_error)
    assert rig.clock.now() - begin < rig.sweep / rig.robot.spec.pan_tilt.max_rate + 3


def test_what_is_no_angle_is_refused_and_changes_nothing(rig: Rig) -> None:
    for pan, tilt in ((math.nan, 0.0), (0.0, math.nan)):
        with pytest.raises(ValueError, match="angle"):
            rig.robot.pan_tilt.move_to(pan, tilt)
    rig.run(0.1)
    state = rig.robot.pan_tilt.state()
    assert (state.pan, state.tilt, state.settled) == (pytest.approx(0, abs=rig.angle_error),) * 2 + (True,)


def test_the_angles_at_a_states_stamp_are_that_states_angles(rig: Rig) -> None:
    rig.robot.pan_tilt.move_to(rig.sweep, 0.2)
    for _ in range(6):
        rig.run(0.05)
        state = rig.robot.pan_tilt.state()
        assert rig.robot.pan_tilt.angles_at(state.stamp) == pytest.approx((state.pan, state.tilt), abs=1e-6)


def test_the_angles_at_other_times_are_the_nearest_known(rig: Rig) -> None:
    state = move(rig, rig.sweep / 4, 0.1)[-1]
    rig.run(0.1)
    assert rig.robot.pan_tilt.angles_at(1e6) == pytest.approx((state.pan, state.tilt), abs=2 * rig.angle_error)
    assert all(math.isfinite(angle) for angle in rig.robot.pan_tilt.angles_at(-1e6))


def test_the_past_is_not_changed_by_a_new_target(rig: Rig) -> None:
    unit = rig.robot.pan_tilt
    unit.move_to(rig.sweep, 0.2)
    rig.run(0.2)
    stamp = unit.state().stamp - 0.1
    before = unit.angles_at(stamp)
    unit.move_to(-rig.sweep, 0.0)
    rig.run(0.2)
    assert unit.angles_at(stamp) == pytest.approx(before, abs=1e-6)


def test_stamps_are_on_the_clock_and_never_go_back(rig: Rig) -> None:
    stamps = []
    for _ in range(10):
        stamp = rig.robot.pan_tilt.state().stamp
        assert rig.clock.now() - rig.stale <= stamp <= rig.clock.now()
        stamps.append(stamp)
        rig.run(PERIOD / 2)
    assert stamps == sorted(stamps)
    assert stamps[-1] > stamps[0]


def test_nothing_blocks(rig: Rig) -> None:
    unit = rig.robot.pan_tilt
    assert duration(unit.state) < 0.002
    assert duration(lambda: unit.angles_at(0.0)) < 0.002
    assert duration(lambda: unit.move_to(0.0, 0.0), 20) < 0.01
    assert duration(unit.stop, 20) < 0.01
