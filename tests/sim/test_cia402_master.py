"""The drives as masters see them that this project has not written: the ``canopen`` package's own."""

from __future__ import annotations

import random
import time
from pathlib import Path
from typing import Any

import canopen
import pytest
from cia402_bench import DEGREE, PAN, TILT, Body, eventually, master, unit

from drivers.pan_tilt.states import State
from sim.devices.cia402 import Cia402Drives, export_eds
from zavis_bt.errors import InputError


def enable(node: Any, mode: str) -> None:
    node.op_mode = mode
    node.state = "OPERATION ENABLED"
    assert node.op_mode == mode


def in_operation(network: canopen.Network, *nodes: Any) -> None:
    for node in nodes:
        node.setup_402_state_machine()
    network.sync.start(0.01)
    network.nmt.state = "OPERATIONAL"


def start_move(node: Any, target: int, bits: int = 0) -> None:
    """The hand-shake of a new set-point."""
    assert eventually(lambda: not node.statusword & 0x1000)
    node.rpdo[1]["Target position"].raw = target
    node.controlword = 0x1F | bits
    assert eventually(lambda: node.statusword & 0x1000)
    node.controlword = 0x0F | bits
    assert eventually(lambda: not node.statusword & 0x1000)


def test_a_master_of_the_canopen_package_enables_moves_and_homes_both_drives() -> None:
    with unit() as (_, body, bus), master(bus, canopen.BaseNode402) as (network, pan, tilt):
        in_operation(network, pan, tilt)
        for node, target in ((pan, 45 * DEGREE), (tilt, -30 * DEGREE)):
            enable(node, "PROFILED POSITION")
            for index, value in ((0x6081, 170), (0x6083, 900), (0x6084, 900)):
                node.sdo[index].raw = value * DEGREE
            start_move(node, target)
        for node, target in ((pan, 45 * DEGREE), (tilt, -30 * DEGREE)):
            assert eventually(lambda node=node: node.statusword & 0x400)
            assert node.sdo["Position actual value"].raw == target
        assert body.degrees == pytest.approx((45, -30))
        pan.sdo["Homing method"].raw = 37
        assert pan.homing()
        assert pan.sdo[0x6064].raw == 0
        assert body.degrees == pytest.approx((45, -30))


def test_the_same_master_works_over_udp_with_a_data_sheet_from_a_file(tmp_path: Path) -> None:
    export_eds(tmp_path / "drive.eds")
    group = f"239.{random.randrange(1, 255)}.{random.randrange(256)}.{random.randrange(1, 255)}"
    port = random.randrange(20000, 30000)  # groups alone keep two buses of one machine not apart
    bus = {"interface": "udp_multicast", "channel": group, "port": port, "fd": False, "hop_limit": 0}
    drives = Cia402Drives(Body(), **bus)
    drives.start()
    network = canopen.Network()
    network.NOTIFIER_CYCLE = 0.05
    try:
        network.connect(**bus)
        heard = [0x80 + PAN, 0x180 + PAN, 0x280 + PAN, 0x580 + PAN, 0x700 + PAN]
        network.bus.set_filters([{"can_id": number, "can_mask": 0x7FF} for number in heard])
        node = canopen.BaseNode402(PAN, str(tmp_path / "drive.eds"))
        node.TIMEOUT_SWITCH_OP_MODE = node.TIMEOUT_SWITCH_STATE_FINAL = node.TIMEOUT_SWITCH_STATE_SINGLE = (
            node.TIMEOUT_CHECK_TPDO
        ) = 5.0
        node.sdo.RESPONSE_TIMEOUT = 2.0
        network.add_node(node)
        node.nmt.state = "PRE-OPERATIONAL"
        in_operation(network, node)
        enable(node, "PROFILED VELOCITY")
        assert drives.state("pan") is State.ENABLED
    finally:
        network.sync.stop()
        network.disconnect()
        drives.close()


def test_a_set_point_waits_for_the_one_before_or_replaces_it_at_once() -> None:
    with unit() as (_, _body, bus), master(bus, canopen.BaseNode402) as (network, pan, _tilt):
        in_operation(network, pan)
        enable(pan, "PROFILED POSITION")
        slow, gentle = 20 * DEGREE, 40 * DEGREE  # half a second within a degree of the far end, for busy machines
        pan.sdo[0x6081].raw, pan.sdo[0x6083].raw, pan.sdo[0x6084].raw = slow, gentle, gentle
        pan.rpdo[1]["Target position"].raw = 20 * DEGREE
        start_move(pan, 20 * DEGREE)
        pan.rpdo[1]["Target position"].raw = 5 * DEGREE
        pan.controlword = 0x1F
        places: list[int] = []
        assert eventually(lambda: pan.statusword & 0x1000)
        pan.controlword = 0x0F
        assert eventually(lambda: places.append(pan.sdo[0x6064].raw) or places[-1] == 5 * DEGREE)
        assert max(places) > 19 * DEGREE
        start_move(pan, 40 * DEGREE)
        start_move(pan, 10 * DEGREE, bits=0x20)
        seen = []
        assert eventually(lambda: seen.append(pan.sdo[0x6064].raw) or seen[-1] == 10 * DEGREE)
        assert max(seen) < 39 * DEGREE
        start_move(pan, 3 * DEGREE, bits=0x40)
        assert eventually(lambda: pan.sdo[0x6064].raw == 13 * DEGREE)


def test_a_halt_holds_a_move_back_until_it_ends() -> None:
    with unit() as (_, _body, bus), master(bus, canopen.BaseNode402) as (network, pan, _tilt):
        in_operation(network, pan)
        enable(pan, "PROFILED POSITION")
        start_move(pan, 15 * DEGREE)
        assert eventually(lambda: pan.sdo[0x6064].raw > DEGREE)
        pan.controlword = 0x10F
        assert eventually(lambda: pan.sdo[0x606C].raw == 0)
        assert pan.sdo[0x6064].raw < 14 * DEGREE
        pan.controlword = 0x0F
        assert eventually(lambda: pan.sdo[0x6064].raw == 15 * DEGREE)


def test_velocity_runs_and_ends_at_the_software_limit() -> None:
    with unit() as (_, _body, bus), master(bus, canopen.BaseNode402) as (network, pan, _tilt):
        in_operation(network, pan)
        pan.sdo[0x607D][1].raw, pan.sdo[0x607D][2].raw = -10 * DEGREE, 10 * DEGREE
        pan.sdo[0x6083].raw = pan.sdo[0x6084].raw = 2000 * DEGREE
        enable(pan, "PROFILED VELOCITY")
        pan.sdo[0x60FF].raw = 40 * DEGREE
        assert eventually(lambda: abs(pan.sdo[0x606C].raw - 40 * DEGREE) < 10)
        assert eventually(lambda: pan.sdo[0x6064].raw == 10 * DEGREE)
        assert pan.sdo[0x6041].raw & 0x800
        pan.sdo[0x60FF].raw = -40 * DEGREE
        assert eventually(lambda: pan.sdo[0x6064].raw < 9 * DEGREE)
        pan.state = "SWITCHED ON"
        assert eventually(lambda: pan.sdo[0x606C].raw == 0)


def test_homing_at_a_limit_switch_finds_the_mechanical_zero() -> None:
    with unit(begin=(-1.9, 0.0)) as (_, body, bus), master(bus, canopen.BaseNode402) as (network, pan, _tilt):
        in_operation(network, pan)
        switch = -116.592  # 2° beyond -2 rad
        values = {0x6098: 17, 0x607C: round(switch * DEGREE), 0x609A: 2000 * DEGREE}
        for index, value in values.items():
            pan.sdo[index].raw = value
        pan.sdo[0x6099][1].raw, pan.sdo[0x6099][2].raw = 60 * DEGREE, 4 * DEGREE
        assert pan.sdo[0x6064].raw == 0
        assert pan.homing()
        pan.controlword = 0x0F
        assert pan.sdo[0x6064].raw / DEGREE == pytest.approx(body.degrees[0], abs=0.3)


def test_a_fault_is_told_and_let_go_after_its_cause_has_gone() -> None:
    with unit() as (drives, _body, bus), master(bus, canopen.BaseNode402) as (network, pan, _tilt):
        in_operation(network, pan)
        enable(pan, "PROFILED POSITION")
        drives.raise_emergency("pan", 0x8611, seconds=0.3)
        assert eventually(lambda: pan.state == "FAULT" and pan.emcy.active)
        assert (pan.emcy.active[0].code, pan.sdo[0x603F].raw, pan.sdo[0x1001].raw) == (0x8611, 0x8611, 0x21)
        pan.controlword = 0x00
        pan.controlword = 0x80
        assert drives.state("pan") is State.FAULT
        time.sleep(0.3)
        pan.reset_from_fault()
        assert pan.state == "OPERATION ENABLED"
        assert eventually(lambda: not pan.emcy.active)
        assert (pan.sdo[0x1003][0].raw, pan.sdo[0x1003][1].raw) == (1, 0x8611)
        pan.sdo[0x1003][0].raw = 0
        assert pan.sdo[0x1003][0].raw == 0


def test_numbers_of_nodes_must_differ() -> None:
    with pytest.raises(InputError, match="two different ones"):
        Cia402Drives(Body(), pan_node=TILT, tilt_node=TILT)
