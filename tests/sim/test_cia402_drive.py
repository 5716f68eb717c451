"""The drives frame by frame."""

from __future__ import annotations

import random
import struct
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import canopen
import pytest
from cia402_bench import DEGREE, PAN, TILT, Body, eventually, master, unit

from drivers.pan_tilt.states import State
from sim.devices.cia402 import Cia402Drives, export_eds, object_dictionary


class Bench:
    """A master that keeps the frames of each identifier."""

    def __init__(self, drives: Cia402Drives, body: Body, network: canopen.Network, pan: Any) -> None:
        self.drives, self.body, self.network, self.pan = drives, body, network, pan
        self.frames: dict[int, list[bytes]] = {}
        for identifier in (0x80 + PAN, 0x180 + PAN, 0x280 + PAN, 0x380 + PAN, 0x700 + PAN):
            network.subscribe(identifier, self._keep)

    def _keep(self, identifier: int, data: bytearray, timestamp: float) -> None:
        self.frames.setdefault(identifier, []).append(bytes(data))

    def heard(self, identifier: int) -> list[bytes]:
        return self.frames.get(identifier, [])

    def start(self) -> None:
        self.network.nmt.state = "OPERATIONAL"
        assert eventually(lambda: self.pan.sdo[0x6041].raw is not None)

    def sync(self) -> bytes:
        """Send SYNC; return TPDO 1."""
        count = len(self.heard(0x180 + PAN))
        self.network.sync.transmit()
        assert eventually(lambda: len(self.heard(0x180 + PAN)) > count)
        return self.heard(0x180 + PAN)[-1]

    def enable(self, mode: int) -> None:
        self.pan.sdo[0x6060].raw = mode
        for word in (0x06, 0x07, 0x0F):
            self.pan.sdo[0x6040].raw = word
        assert self.drives.state("pan") is State.ENABLED


@pytest.fixture
def bench() -> Iterator[Bench]:
    with unit() as (drives, body, bus), master(bus) as (network, pan, _):
        yield Bench(drives, body, network, pan)


def test_process_data_flow_in_operational_only(bench: Bench) -> None:
    assert eventually(lambda: bench.pan.sdo[0x1000].raw == 0x20192)
    bench.network.sync.transmit()
    time.sleep(0.1)
    assert not bench.heard(0x180 + PAN)
    bench.start()
    word, position = struct.unpack("<Hi", bench.sync())
    assert (word & 0x6F, position) == (0x40, 0)
    bench.network.nmt.state = "STOPPED"
    bench.pan.sdo.RESPONSE_TIMEOUT = 0.2
    with pytest.raises(canopen.SdoCommunicationError):
        _ = bench.pan.sdo[0x1000].raw


def test_a_received_pdo_is_one_command(bench: Bench) -> None:
    bench.start()
    bench.enable(1)
    bench.network.send_message(0x200 + PAN, struct.pack("<Hi", 0x1F, 2 * DEGREE))
    assert eventually(lambda: bench.pan.sdo[0x6064].raw == 2 * DEGREE)


def test_synchronous_commands_wait_for_sync(bench: Bench) -> None:
    bench.pan.sdo[0x1400][2].raw = 1
    bench.start()
    bench.enable(1)
    bench.network.send_message(0x200 + PAN, struct.pack("<Hi", 0x1F, 2 * DEGREE))
    assert not bench.pan.sdo[0x6041].raw & 0x1000
    bench.sync()
    assert bench.pan.sdo[0x6041].raw & 0x1000


def test_a_drive_stops_when_the_watched_heartbeat_is_lost(bench: Bench) -> None:
    bench.start()
    bench.pan.sdo[0x1016][1].raw = 127 << 16 | 300
    bench.enable(3)
    bench.pan.sdo[0x60FF].raw = 20 * DEGREE
    for _ in range(5):
        bench.network.send_message(0x700 + 127, b"\x05")
        time.sleep(0.02)
    assert bench.drives.state("pan") is State.ENABLED
    assert eventually(lambda: bench.drives.state("pan") is State.FAULT)
    assert bench.pan.sdo[0x606C].raw == 0
    assert eventually(lambda: bench.heard(0x80 + PAN))
    assert bench.heard(0x80 + PAN)[0][:2] == b"\x30\x81"


def test_set_points_of_each_sync_are_followed(bench: Bench) -> None:
    bench.start()
    bench.pan.sdo[0x60C2][1].raw = 10
    bench.enable(8)
    due = time.monotonic()
    for number in range(50):
        bench.network.send_message(0x200 + PAN, struct.pack("<Hi", 0x0F, number * 100))
        bench.network.sync.transmit()
        due += 0.01
        time.sleep(max(due - time.monotonic(), 0.0))
    for _ in range(30):
        bench.network.sync.transmit()
        time.sleep(0.01)
    assert abs(bench.pan.sdo[0x6064].raw - 4900) <= 2
    bench.network.send_message(0x200 + PAN, struct.pack("<Hi", 0x0F, 10**8))
    assert eventually(lambda: bench.sync() and bench.pan.sdo[0x6064].raw == bench.pan.sdo[0x607D][2].raw)


def test_a_jump_of_the_set_point_overshoots_little(bench: Bench) -> None:
    bench.start()
    bench.pan.sdo[0x60C2][1].raw = 10
    bench.enable(8)
    places = []
    bench.network.send_message(0x200 + PAN, struct.pack("<Hi", 0x0F, 40 * DEGREE))
    assert eventually(
        lambda: places.append(struct.unpack("<Hi", bench.sync())[1]) or abs(places[-1] - 40 * DEGREE) < 20
    )
    assert max(places) < 44 * DEGREE


def test_events_are_sent_on_change_and_by_the_timer(bench: Bench) -> None:
    bench.pan.sdo[0x1802][1].raw = 1 << 31 | 0x380 + PAN
    bench.pan.sdo[0x1A02][1].raw = 0x6061 << 16 | 8
    bench.pan.sdo[0x1A02][0].raw = 1
    bench.pan.sdo[0x1802][2].raw = 255
    bench.pan.sdo[0x1802][1].raw = 0x380 + PAN
    bench.start()
    assert eventually(lambda: bench.heard(0x380 + PAN) == [b"\0"])
    bench.pan.sdo[0x6060].raw = 8
    assert eventually(lambda: bench.heard(0x380 + PAN) == [b"\0", b"\x08"])
    bench.pan.sdo[0x1802][5].raw = 20
    assert eventually(lambda: len(bench.heard(0x380 + PAN)) > 6)


@pytest.mark.parametrize(
    ("index", "sub", "data", "code"),
    [
        (0x2000, 0, b"\0", 0x06020000),
        (0x1018, 9, b"\0", 0x06090011),
        (0x6041, 0, b"\0\0", 0x06010002),
        (0x6060, 0, b"\x04", 0x06090030),
        (0x607A, 0, b"\0", 0x06070010),
        (0x1600, 1, b"\x10\x00\x40\x60", 0x08000022),
        (0x1602, 1, b"\x10\x00\x41\x60", 0x06040041),
        (0x1602, 1, b"\x10\x00\x64\x60", 0x06040041),
        (0x1602, 0, b"\x02", 0x06040041),
    ],
)
def test_wrong_writes_are_refused_with_the_standard_s_code(
    bench: Bench, index: int, sub: int, data: bytes, code: int
) -> None:
    with pytest.raises(canopen.SdoAbortedError) as refused:
        bench.pan.sdo.download(index, sub, data)
    assert refused.value.code == code


def test_quick_stop_ends_in_switch_on_disabled_or_stays(bench: Bench) -> None:
    bench.start()
    for option, expected in ((6, State.QUICK_STOP), (2, State.SWITCH_ON_DISABLED)):
        bench.pan.sdo[0x605A].raw = option
        bench.enable(3)
        bench.pan.sdo[0x60FF].raw = 20 * DEGREE
        bench.pan.sdo[0x6040].raw = 0x02
        assert eventually(lambda: bench.pan.sdo[0x606C].raw == 0)
        assert eventually(lambda expected=expected: bench.drives.state("pan") is expected)
        bench.pan.sdo[0x6040].raw = 0x00


def test_a_silent_drive_is_neither_heard_nor_does_it_hear(bench: Bench) -> None:
    bench.start()
    bench.drives.silence("pan", 0.3)
    bench.pan.sdo.RESPONSE_TIMEOUT = 0.1
    with pytest.raises(canopen.SdoCommunicationError):
        _ = bench.pan.sdo[0x1000].raw
    bench.pan.sdo.RESPONSE_TIMEOUT = 2.0
    assert eventually(lambda: not bench.drives._silent)
    assert bench.pan.sdo[0x1000].raw == 0x20192


def test_a_restart_and_a_reset_begin_with_a_boot_up_message(bench: Bench) -> None:
    bench.start()
    bench.pan.sdo[0x6081].raw = 5
    bench.drives.restart("pan")
    assert eventually(lambda: bench.heard(0x700 + PAN).count(b"\0") == 1)
    assert bench.pan.sdo[0x6081].raw == 45 * DEGREE
    bench.network.send_message(0, bytes([0x81, PAN]))
    assert eventually(lambda: bench.heard(0x700 + PAN).count(b"\0") == 2)


def test_random_frames_end_nothing(bench: Bench) -> None:
    rng = random.Random(5)
    services = [0x000, 0x080, 0x200, 0x300, 0x580, 0x600, 0x700]
    for _ in range(1000):
        identifier = rng.choice(services) + rng.choice((0, PAN, TILT, 127))
        if identifier != 0x600:
            bench.network.send_message(identifier, rng.randbytes(rng.randrange(9)))
    bench.network.nmt.state = "RESET"
    bench.network.nmt.state = "PRE-OPERATIONAL"
    assert eventually(lambda: answers(bench))


def answers(bench: Bench) -> bool:
    """Whether the drive answers; answers to what came before may come first."""
    try:
        return bool(bench.pan.sdo[0x1000].raw == 0x20192)
    except canopen.SdoAbortedError:
        return False


def test_the_data_sheet_says_what_the_dictionary_holds(tmp_path: Path) -> None:
    export_eds(tmp_path / "drive.eds")
    read, made = canopen.import_od(str(tmp_path / "drive.eds"), 3), object_dictionary(3)
    assert list(read) == list(made)
    for index in made:
        wanted = made[index]
        variables = [wanted] if not hasattr(wanted, "values") else list(wanted.values())
        for variable in variables:
            if (index, variable.subindex) == (0x1018, 4):
                continue  # each drive has a serial number of its own
            found = read.get_variable(index, variable.subindex)
            assert (found.data_type, found.access_type, found.default, found.pdo_mappable) == (
                variable.data_type,
                variable.access_type,
                variable.default,
                variable.pdo_mappable,
            )


def test_a_set_point_that_waited_stays_acknowledged_until_the_master_takes_its_bit_back(bench: Bench) -> None:
    bench.enable(1)
    for target in (2 * DEGREE, 4 * DEGREE):
        bench.pan.sdo[0x607A].raw = target
        bench.pan.sdo[0x6040].raw = 0x1F
        assert bench.pan.sdo[0x6041].raw & 0x1000
        if target == 2 * DEGREE:
            bench.pan.sdo[0x6040].raw = 0x0F
    assert eventually(lambda: bench.pan.sdo[0x6064].raw == 4 * DEGREE)  # the move that waited has long begun
    assert bench.pan.sdo[0x6041].raw & 0x1000
    bench.pan.sdo[0x6040].raw = 0x0F
    assert not bench.pan.sdo[0x6041].raw & 0x1000
