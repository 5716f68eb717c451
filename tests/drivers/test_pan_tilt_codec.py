from __future__ import annotations

import random
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.pan_tilt.axis import Axis
from drivers.pan_tilt.emergencies import clears, describe
from drivers.pan_tilt.history import AngleHistory
from drivers.pan_tilt.objects import mapping
from drivers.pan_tilt.states import State, decode_state, towards_operation


def test_a_mapping_word_is_index_sub_index_and_bits() -> None:
    assert mapping(0x6041, 0, 16) == 0x6041_0010
    assert mapping(0x607D, 2, 32) == 0x607D_0220


@pytest.mark.parametrize(
    ("state", "word"),
    [
        (State.SWITCH_ON_DISABLED, 0x06),
        (State.READY, 0x07),
        (State.SWITCHED_ON, 0x0F),
        (State.ENABLED, 0x0F),
        (State.QUICK_STOP, 0x00),
        (State.NOT_READY, 0x00),
        (State.FAULT, 0x00),
        (None, 0x00),
    ],
)
def test_the_way_to_operation_is_the_profile_s(state: State | None, word: int) -> None:
    assert towards_operation(state) == word


@pytest.mark.parametrize("word", [0x0027, 0x1637, 0x0237])
def test_operation_enabled_is_told_whatever_the_other_bits(word: int) -> None:
    assert decode_state(word) is State.ENABLED


@given(st.integers(0, 0xFFFF))
def test_every_error_code_has_words(code: int) -> None:
    assert describe(code).startswith(f"{code:04X} ")
    assert len(describe(code)) > 8
    assert clears(code) == (code < 0x100)


@pytest.mark.parametrize(
    ("code", "words"),
    [(0x8611, "following error"), (0x8130, "heartbeat"), (0x2310, "over-current"), (0x4211, "temperature")],
)
def test_error_codes_are_told_by_name_or_family(code: int, words: str) -> None:
    assert words in describe(code)


def test_measurements_come_in_radians_whichever_way_the_drive_counts() -> None:
    for units in (2000.0, -2000.0):
        axis = Axis("pan", 5, units)
        assert axis.receive(0x185, struct.pack("<Hi", 0x1237, axis.to_units(0.75)))
        assert axis.angle == pytest.approx(0.75)
        assert axis.state is State.ENABLED


def test_an_emergency_is_active_until_it_is_cleared() -> None:
    axis = Axis("tilt", 2, 1000.0)
    axis.receive(0x82, struct.pack("<HB5x", 0x8611, 1))
    assert axis.emergency == 0x8611
    axis.receive(0x82, bytes(8))
    assert axis.emergency == 0
    assert [code for _, code in axis.emergencies] == [0x8611, 0]


def test_a_heartbeat_from_before_the_start_takes_no_drive_out_of_operation() -> None:
    axis = Axis("pan", 1, 1000.0)
    axis.receive(0x701, b"\x7f")
    assert not axis.operational
    axis.receive(0x181, bytes(6))
    assert axis.operational
    axis.receive(0x701, b"\x04")
    assert not axis.operational


def test_a_hundred_thousand_random_frames_raise_nothing_and_fill_no_memory() -> None:
    rng, axis = random.Random(3), Axis("pan", 1, 57295.8)
    services = (0x81, 0x181, 0x281, 0x701)
    for _ in range(100_000):
        axis.receive(rng.choice(services), rng.randbytes(rng.randrange(9)))
    assert len(axis.emergencies) <= 20
    axis.receive(0x181, struct.pack("<Hi", 0x0637, 7))
    assert (axis.state, axis.position) == (State.ENABLED, 7)


def test_angles_are_found_between_measurements() -> None:
    history = AngleHistory()
    assert history.at(1.0) == (0.0, 0.0)
    for step in range(200):
        history.add(step * 0.02, 0.5 * step * 0.02, -step * 0.02)
    assert history.at(3.011) == pytest.approx((1.5055, -3.011))
    assert history.at(-5.0) == history.at(0.97)
    assert history.latest == pytest.approx((3.98, 1.99, -3.98))
    assert history.at(99.0)[0] == pytest.approx(0.5 * (3.98 + 0.05))
