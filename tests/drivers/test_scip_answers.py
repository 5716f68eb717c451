from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.lidar.codec import AnswerDecoder, ScanRequest, encode_answer, encode_readings, seal, seal_information

EXAMPLE = b"MD0000000201001\n00P\n\nMD0000000201000\n99b\n0N90W\n0?X0?Y0?ZH\n\n"
REQUEST = ScanRequest("MD", 0, 180)


def scan(clock: int, seed: int = 0) -> bytes:
    values = np.random.default_rng(seed).integers(20, 10_000, REQUEST.beams, dtype=np.int32)
    return encode_answer(REQUEST.line, "99", encode_readings(clock, values, 3))


def clocks(answers) -> list[int]:
    return [answer.readings.clock for answer in answers if answer.readings is not None]


def test_the_worked_example_is_an_acknowledgement_and_a_scan():
    acknowledged, measured = AnswerDecoder().feed(EXAMPLE)
    assert (acknowledged.echo, acknowledged.status, acknowledged.readings) == (b"MD0000000201001", "00", None)
    assert (measured.echo, measured.status) == (b"MD0000000201000", "99")
    assert measured.readings.ranges.tolist() == [1000, 1001, 1002]


def test_lines_come_without_check_characters():
    lines = seal_information(b"MODL:UST-10LX") + b"\n" + seal(b"DMIN:20;") + b"\n"
    (answer,) = AnswerDecoder().feed(encode_answer(b"PP;mine", "00", lines))
    assert (answer.echo, answer.lines) == (b"PP;mine", (b"MODL:UST-10LX", b"DMIN:20"))


def test_a_semicolon_at_the_end_of_a_time_is_a_digit():
    (answer,) = AnswerDecoder().feed(encode_answer(b"TM1", "00", seal(b"005;") + b"\n"))
    assert answer.lines == (b"005;",)


@given(st.lists(st.integers(1, 40)))
def test_it_does_not_matter_how_the_bytes_are_cut(sizes):
    decoder, data, found = AnswerDecoder(), EXAMPLE + scan(5), []
    for size in sizes:
        found += decoder.feed(data[:size])
        data = data[size:]
    found += decoder.feed(data)
    assert clocks(found) == [123456, 5]
    assert (len(found), decoder.answers, decoder.broken, decoder.garbage) == (3, 3, 0, 0)


@pytest.mark.parametrize(
    "garbage",
    [b"", b"\n", b"\n\n\n", b"xyz", b"MD000", b"QT\n00", b"MD0000018001000\n99b\n0N90W\n0?X0", b"\xff\x00\n" * 9],
)
def test_an_answer_after_garbage_is_found(garbage):
    decoder = AnswerDecoder()
    assert clocks(decoder.feed(garbage + scan(1) + scan(2))) == [1, 2]


def test_a_damaged_scan_is_counted_and_the_next_one_is_found():
    damaged = bytearray(scan(1))
    damaged[200] ^= 1
    decoder = AnswerDecoder()
    assert clocks(decoder.feed(bytes(damaged) + scan(2))) == [2]
    assert decoder.broken == 1


def test_a_scan_whose_end_got_lost_does_not_take_the_next_one_with_it():
    decoder = AnswerDecoder()
    assert clocks(decoder.feed(scan(1)[:-40] + scan(2) + scan(3))) == [2, 3]
    assert decoder.broken == 1


@given(st.integers(0, len(scan(1)) - 1), st.integers(1, 255))
def test_no_single_wrong_byte_gives_wrong_readings(place, change):
    sound, data = AnswerDecoder().feed(scan(1))[0].readings, bytearray(scan(1))
    data[place] ^= change
    answers = AnswerDecoder().feed(bytes(data) + scan(2, seed=1))
    assert clocks(answers)[-1] == 2
    for answer in answers[:-1]:
        if answer.echo == REQUEST.line:
            assert np.array_equal(answer.readings.ranges, sound.ranges)


@given(st.binary(max_size=500))
def test_any_bytes_are_taken_and_the_answer_after_them_is_found(data):
    decoder = AnswerDecoder()
    decoder.feed(data)
    assert clocks(decoder.feed(scan(7)))[-1:] == [7]


def mutated(rng: np.random.Generator, size: int) -> bytes:
    """Scans with a wrong, a missing or a doubled piece here and there."""
    data = bytearray(b"".join(scan(i, i) for i in range(size // len(scan(0)))))
    for place in rng.integers(0, len(data), len(data) // 150).tolist():
        match rng.integers(3):
            case 0:
                data[place] = int(rng.integers(256))
            case 1:
                del data[place : place + 3]
            case _:
                data[place:place] = data[place : place + 5]
    return bytes(data)


def test_a_million_random_and_damaged_bytes_leave_memory_flat_and_the_next_answer_is_found():
    rng, decoder = np.random.default_rng(3), AnswerDecoder()
    pieces = [rng.bytes(500_000), mutated(rng, 250_000), b"0" * 250_000]
    tracemalloc.start()
    for piece in pieces:
        for at in range(0, len(piece), 4096):
            decoder.feed(piece[at : at + 4096])
        assert clocks(decoder.feed(b"\n" + scan(9)))[-1:] == [9]
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2_000_000
    assert decoder.broken > 100
