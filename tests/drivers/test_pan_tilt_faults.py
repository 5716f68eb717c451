from __future__ import annotations

import random

import can
import pytest
from pan_tilt_bench import arrives, drives_on, eventually, new_bus, pan_tilt

from drivers.pan_tilt import CanPanTilt, open_pan_tilt
from drivers.pan_tilt.states import State
from zavis_bt.errors import DeviceError

QUICK = {"answer_timeout": 0.4, "heartbeat_timeout": 0.5, "sdo_timeout": 0.3}


def test_a_fault_of_one_axis_ends_the_motion_of_both_until_commanded_anew() -> None:
    with pan_tilt({"mode": "profile"}) as (device, drives, body):
        device.move_to(2.0, 0.4)
        assert eventually(lambda: device.state().pan > 0.05)
        drives.raise_emergency("tilt", 0x8611, seconds=0.1)
        assert eventually(lambda: device.state().fault)
        assert device.state().fault.startswith("tilt (node 2): 8611 following error")
        with pytest.raises(DeviceError, match="following error"):
            device.move_to(0.0, 0.0)
        assert eventually(lambda: not device.state().fault)
        rest = body.angles
        assert rest[0] < 1.99
        assert drives.state("pan") is drives.state("tilt") is State.ENABLED
        assert device.state().pan == pytest.approx(rest[0], abs=0.01)
        assert arrives(device, device.state().pan - 0.1, 0.1)


def test_a_fault_whose_cause_stays_is_told_until_it_goes() -> None:
    with pan_tilt() as (device, drives, _):
        drives.raise_emergency("pan", 0x4210, seconds=0.6)
        assert eventually(lambda: "4210 drive too hot" in device.state().fault)
        assert any("too hot" in problem for problem in device.report().problems)
        assert eventually(lambda: not device.state().fault)
        assert "4210" in device.report().figures["pan (node 1)"]


def test_a_silent_drive_stops_the_other_and_is_taken_back_when_it_is_heard() -> None:
    with pan_tilt(QUICK) as (device, drives, body):
        device.move_to(0.3, 0.0)
        drives.silence("tilt")
        assert eventually(lambda: "tilt (node 2) does not answer" in device.state().fault)
        stamp = device.state().stamp
        assert eventually(lambda: drives.state("tilt") is State.FAULT)  # it has lost our heartbeat
        assert eventually(lambda: drives.state("pan") is State.SWITCH_ON_DISABLED)
        assert device.state().stamp == stamp
        rest = body.angles
        device.stop()
        drives.resume("tilt")
        assert eventually(lambda: not device.state().fault)
        assert body.angles == pytest.approx(rest, abs=1e-3)
        assert device.state().stamp > stamp
        assert arrives(device, device.state().pan - 0.1, 0.1)


def test_a_drive_that_restarts_is_prepared_again_and_homed_again() -> None:
    with pan_tilt({"homing": {"method": 37, "tilt_offset_deg": 5.0}}) as (device, drives, _):
        assert arrives(device, 0.1, 0.1)
        drives.restart("tilt")
        assert eventually(lambda: "restarted" in device.state().fault)
        assert eventually(lambda: not device.state().fault)
        assert device.state().tilt == pytest.approx(0.0873, abs=1e-3)


def test_a_drive_that_somebody_else_switches_off_is_told_and_brought_back() -> None:
    bus = new_bus()
    with pan_tilt(bus=bus) as (device, _, _body), can.Bus(**bus) as other:
        other.send(can.Message(arbitration_id=0, is_extended_id=False, data=[2, 1]))
        assert eventually(lambda: "pan (node 1)" in device.state().fault)
        assert eventually(lambda: not device.state().fault)
        assert arrives(device, 0.1, 0.0)


def test_both_drives_gone_and_back_is_one_fault() -> None:
    with pan_tilt(QUICK) as (device, drives, _):
        for axis in ("pan", "tilt"):
            drives.silence(axis)
        assert eventually(lambda: "does not answer" in device.state().fault)
        for axis in ("pan", "tilt"):
            drives.resume(axis)
        assert eventually(lambda: not device.state().fault)
        assert device.report().figures["faults"] == "1"


def test_closing_in_the_midst_of_a_fault_takes_no_long_time() -> None:
    with pan_tilt(QUICK) as (device, drives, _):
        drives.silence("pan")
        assert eventually(lambda: device.state().fault)
        device.close()
        assert not device._thread.is_alive()


def test_the_drives_stop_when_the_driver_is_gone() -> None:
    with pan_tilt({"heartbeat_timeout": 0.4}) as (device, drives, _):
        device._unit._line._closed.set()  # as if the process had been killed: no more frames, no farewell
        assert eventually(lambda: drives.state("pan") is State.FAULT)
        assert drives.state("tilt") is State.FAULT


def recovered(device: CanPanTilt) -> bool:
    """Whether a move succeeds now."""
    try:
        device.move_to(0.2, -0.1)
    except DeviceError:
        return False
    return eventually(lambda: device.state().settled or device.state().fault) and device.state().settled


def test_random_frames_on_the_bus_cannot_end_the_driver() -> None:
    bus, rng = new_bus(), random.Random(11)
    with pan_tilt(QUICK, bus=bus) as (device, _, _body), can.Bus(**bus) as other:
        services = (0x80, 0x180, 0x200, 0x280, 0x580, 0x600, 0x700)
        for _ in range(3000):
            identifier = rng.choice(services) + rng.choice((1, 2, 127))
            data = rng.randbytes(rng.randrange(9))
            other.send(can.Message(arbitration_id=identifier, is_extended_id=False, data=data))
        assert device._thread.is_alive()
        other.send(can.Message(arbitration_id=0, is_extended_id=False, data=[0x81, 0]))
        assert eventually(lambda: device.state().fault)
        assert eventually(lambda: recovered(device))


def test_a_hundred_thousand_random_frames_from_the_drives_raise_nothing() -> None:
    rng = random.Random(12)
    with pan_tilt() as (device, _, _body):
        line = device._unit._line
        for _ in range(100_000):
            identifier = rng.choice((0x80, 0x180, 0x280, 0x580, 0x700)) + rng.choice((1, 2))
            line._hand_on(identifier, rng.randbytes(rng.randrange(9)), 0.0)
        assert device._thread.is_alive()
        assert eventually(lambda: recovered(device))


def test_an_attempt_on_a_bus_without_drives_names_the_node_and_the_remedy() -> None:
    bus = new_bus()
    with drives_on(bus) as (drives, body):
        drives.silence("tilt")
        with pytest.raises(
            DeviceError, match=r"^my.robot.yaml: devices.pan_tilt: tilt \(node 2\) does not answer .*power"
        ):
            open_pan_tilt({**bus, "sdo_timeout": 0.1}, body.context())
