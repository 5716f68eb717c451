from __future__ import annotations

import math
import random
import time
from collections.abc import Iterator
from typing import Any

import pytest
from pan_tilt_bench import SPEC, Body, arrives, eventually, pan_tilt

from drivers.pan_tilt import CanPanTilt
from drivers.pan_tilt.states import State
from sim.devices.cia402 import Cia402Drives
from zavis_bt.errors import DeviceError

Unit = tuple[CanPanTilt, Cia402Drives, Body]


@pytest.fixture(scope="module")
def unit() -> Iterator[Unit]:
    """One for the tests that leave it in order."""
    with pan_tilt() as opened:
        yield opened


@pytest.mark.parametrize("mode", ["cyclic", "profile"])
def test_it_moves_where_it_is_told_and_measures_where_the_shafts_are(mode: str) -> None:
    with pan_tilt({"mode": mode}) as (device, _, body):
        assert device.state().settled
        assert arrives(device, 0.3, -0.2)
        assert eventually(lambda: body.angles == pytest.approx((0.3, -0.2), abs=1e-3))
        assert arrives(device, 0.1, 0.1)
        assert not device.state().fault


def test_a_drive_of_other_units_and_direction_moves_the_same_way() -> None:
    settings: dict[str, Any] = {"units_per_degree": 50.0, "pan_inverted": True}
    with pan_tilt(settings, units_per_degree=50.0) as (device, _, body):
        assert arrives(device, 0.3, -0.2)
        assert eventually(lambda: body.angles == pytest.approx((-0.3, -0.2), abs=1e-3))


def test_it_works_over_udp_multicast() -> None:
    group = f"239.{random.randrange(1, 255)}.{random.randrange(256)}.{random.randrange(1, 255)}"
    with pan_tilt(bus={"interface": "udp_multicast", "channel": group}) as (device, _, body):
        assert arrives(device, 0.5, -0.3)
        assert eventually(lambda: body.angles == pytest.approx((0.5, -0.3), abs=1e-3))


def test_targets_are_clipped_to_the_limits(unit: Unit) -> None:
    device, _, body = unit
    device.move_to(9.0, -9.0)
    assert eventually(lambda: device.state().settled)
    assert eventually(lambda: body.angles == pytest.approx((SPEC.pan_max, SPEC.tilt_min), abs=1e-3))


def test_what_is_no_angle_is_refused(unit: Unit) -> None:
    device, _, _body = unit
    with pytest.raises(ValueError, match="not an angle"):
        device.move_to(math.nan, 0.0)
    assert device.state().settled


def test_a_move_is_unsettled_at_once_and_the_same_one_stays_settled(unit: Unit) -> None:
    device, _, _body = unit
    assert arrives(device, 0.2, 0.0)
    device.move_to(0.3, 0.1)
    assert not device.state().settled
    assert eventually(lambda: device.state().settled)
    device.move_to(0.3, 0.1)
    assert device.state().settled


@pytest.mark.parametrize("mode", ["cyclic", "profile"])
def test_stop_ends_a_move_on_the_way_and_the_next_move_works(mode: str) -> None:
    with pan_tilt({"mode": mode}) as (device, _, body):
        device.move_to(2.0, 0.0)
        assert eventually(lambda: device.state().pan > 0.1)
        device.stop()
        assert eventually(lambda: device.state().settled)
        stopped = body.angles
        assert stopped[0] < 1.9
        time.sleep(0.1)
        assert body.angles == pytest.approx(stopped, abs=2e-3)
        assert arrives(device, stopped[0] - 0.1, 0.1)


def test_both_axes_move_all_the_way_in_proportion(unit: Unit) -> None:
    device, _, _body = unit
    assert arrives(device, 0.0, 0.0)
    device.move_to(0.8, -0.2)
    shares = []
    while not device.state().settled:
        state = device.state()
        shares.append((state.pan / 0.8, state.tilt / -0.2))
        time.sleep(0.01)
    late = [pan for pan, tilt in shares if tilt > 0.99 or pan > 0.99]
    assert late
    assert min(late) > 0.9


def test_past_angles_are_those_of_the_shafts(unit: Unit) -> None:
    device, _, body = unit
    assert arrives(device, 0.0, 0.0)
    device.move_to(1.8, 0.0)
    assert eventually(lambda: device.state().pan > 0.2)
    begin = body.now
    assert eventually(lambda: device.state().stamp > begin + 0.1)
    now = body.now
    for ago in (0.1, 0.15, 0.2):
        assert device.angles_at(now - ago)[0] == pytest.approx(
            body.joints(body.now - (body.now - now) - ago)[0], abs=0.05
        )


def test_homing_at_the_switches_corrects_where_the_unit_stood_when_switched_on() -> None:
    homing = {
        "method": 17,
        "pan_offset_deg": math.degrees(SPEC.pan_min) - 2,
        "tilt_offset_deg": math.degrees(SPEC.tilt_min) - 2,
        "speed_deg": 360,
    }
    with pan_tilt({"homing": homing}, begin=(-1.9, -0.7)) as (device, _, body):
        assert arrives(device, -1.8, -0.6)
        assert body.angles == pytest.approx((-1.8, -0.6), abs=0.03)


def test_homing_in_place_makes_the_present_angles_the_offset() -> None:
    with pan_tilt({"homing": {"method": 37, "pan_offset_deg": 10.0}}) as (device, _, _body):
        assert device.state().pan == pytest.approx(math.radians(10), abs=1e-4)


def test_close_leaves_the_drives_at_rest_without_voltage() -> None:
    with pan_tilt() as (device, drives, body):
        device.move_to(2.0, 0.3)
        assert eventually(lambda: device.state().pan > 0.2)
        device.close()
        device.close()
        assert eventually(lambda: drives.state("pan") is State.SWITCH_ON_DISABLED)
        assert drives.state("tilt") is State.SWITCH_ON_DISABLED
        rest = body.angles
        time.sleep(0.1)
        assert body.angles == rest
        device.stop()
        with pytest.raises(DeviceError, match="closed"):
            device.move_to(0.0, 0.0)


def test_the_report_tells_who_the_drives_are_and_how_they_do(unit: Unit) -> None:
    device, _, _body = unit
    assert arrives(device, 0.1, 0.1)
    report = device.report()
    assert "Simulated pan-tilt drive" in report.model
    assert (report.firmware, report.serial) == ("1.0", "1, 2")
    assert "100 Hz" in report.figures["cycle"]
    assert "ms" in report.figures["SYNC to measurement"]
    assert "operation enabled" in report.figures["pan (node 1)"]
    assert not [problem for problem in report.problems if "late" not in problem]


def test_the_stamp_is_on_the_mission_s_clock(unit: Unit) -> None:
    device, _, body = unit
    begin = body.now
    assert eventually(lambda: device.state().stamp > begin)
    assert device.state().stamp <= body.now
