from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.lidar import codec
from drivers.lidar.codec import (
    CLOCK_SPAN,
    PARAMETERS,
    CodecError,
    Parameters,
    Request,
    RequestError,
    ScanRequest,
    checksum,
    decode_information,
    decode_number,
    decode_readings,
    encode_information,
    encode_number,
    encode_numbers,
    encode_readings,
    join_digits,
    pack_block,
    parse_request,
    seal,
    seal_information,
    unpack_block,
    unseal,
    unseal_information,
)


def test_every_public_name_exists():
    assert all(hasattr(codec, name) for name in codec.__all__)


@pytest.mark.parametrize(
    ("status", "sealed"),
    [
        ("00", "P"),
        ("99", "b"),
        ("01", "Q"),
        ("02", "R"),
        ("04", "T"),
        ("0E", "e"),
        ("0F", "f"),
        ("10", "Q"),
        ("21", "S"),
    ],
)
def test_status_lines_have_the_check_character_of_the_specification(status, sealed):
    assert seal(status.encode()) == f"{status}{sealed}".encode()


@pytest.mark.parametrize(
    "line",
    [
        "MODL:UST-10LX;D",
        "DMIN:20;4",
        "DMAX:30000;G",
        "ARES:1440;^",
        "AMIN:0;?",
        "AMAX:1080;Z",
        "AFRT:540;0",
        "SCAN:2400;U",
    ],
)
def test_the_semicolon_of_an_information_line_is_not_counted(line):
    content = line[:-2].encode()
    assert seal_information(content) == line.encode()
    assert unseal_information(line.encode()) == content


@given(st.binary(min_size=1, max_size=40).filter(lambda content: not content.endswith(b";")))
def test_information_lines_are_read_whether_the_semicolon_is_counted_or_not(content):
    assert unseal_information(content + b";" + bytes([checksum(content)])) == content
    assert unseal_information(seal(content + b";")) == content
    assert unseal_information(seal(content)) == content


@pytest.mark.parametrize("line", [b"", b"P", b"00Q", b"DMIN:20;5"])
def test_a_line_with_a_wrong_check_character_is_refused(line):
    for check in (unseal, unseal_information):
        with pytest.raises(CodecError, match="checksum"):
            check(line)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1234, b"CB"),
        (4095, b"oo"),
        (5432, b"1Dh"),
        (1000, b"0?X"),
        (30000, b"\x37\x44\x60"),
        (65533, b"?om"),
        (16000000, b"m2@0"),
        (123456, b"0N90"),
    ],
)
def test_numbers_are_written_as_in_the_specification(value, text):
    assert encode_number(value, len(text)) == text
    assert decode_number(text) == value
    assert encode_numbers(np.array([value, 0], dtype=np.int32), len(text)) == text + b"0" * len(text)


@given(st.sampled_from([2, 3, 4]), st.data())
def test_numbers_come_back_one_by_one_and_all_at_once(digits, data):
    values = data.draw(st.lists(st.integers(0, (1 << 6 * digits) - 1), max_size=70))
    text = encode_numbers(np.array(values, dtype=np.int32), digits)
    assert text == b"".join(encode_number(value, digits) for value in values)
    assert join_digits(unpack_block(pack_block(text)), digits).tolist() == values


@pytest.mark.parametrize(("value", "digits"), [(-1, 3), (4096, 2), (262144, 3), (CLOCK_SPAN, 4)])
def test_a_number_that_does_not_fit_is_refused(value, digits):
    with pytest.raises(ValueError, match="fit"):
        encode_number(value, digits)
    with pytest.raises(ValueError, match="fit"):
        encode_numbers(np.array([value], dtype=np.int32), digits)


@pytest.mark.parametrize("text", [b"0 0", b"0p0", b"\xff"])
def test_characters_that_stand_for_no_number_are_refused(text):
    with pytest.raises(CodecError, match="number"):
        decode_number(text)
    with pytest.raises(CodecError, match="stands for no number"):
        unpack_block(seal(text) + b"\n")


def test_1081_readings_take_50_full_lines_and_one_of_43_characters():
    block = pack_block(encode_numbers(np.arange(1081, dtype=np.int32), 3))
    lines = block.split(b"\n")
    assert [len(line) for line in lines] == [65] * 50 + [44, 0]
    assert all(seal(line[:-1]) == line for line in lines[:-1])


def test_whole_lines_have_no_empty_line_after_them():
    assert pack_block(b"0" * 128).count(b"\n") == 2
    assert pack_block(b"") == b""


@given(st.binary(max_size=200), st.data())
def test_any_single_wrong_byte_in_a_block_is_found(text, data):
    block = bytearray(pack_block(bytes(0x30 + byte % 64 for byte in text) or b"0"))
    place = data.draw(st.integers(0, len(block) - 1))
    block[place] ^= data.draw(st.integers(1, 255))
    with pytest.raises(CodecError):
        unpack_block(bytes(block))


def test_the_worked_example_is_written_and_read():
    body = encode_readings(123456, np.array([1000, 1001, 1002], dtype=np.int32), 3)
    assert body == b"0N90W\n0?X0?Y0?ZH\n"
    readings = decode_readings("GD", body)
    assert (readings.clock, readings.ranges.tolist(), readings.intensities) == (123456, [1000, 1001, 1002], None)


def test_ranges_and_intensities_alternate():
    readings = decode_readings("ME", encode_readings(7, np.array([1000, 50, 2000, 60], dtype=np.int32), 3))
    assert readings.ranges.tolist() == [1000, 2000]
    assert readings.intensities is not None
    assert readings.intensities.tolist() == [50, 60]
    with pytest.raises(CodecError, match="intensity"):
        decode_readings("ME", encode_readings(7, np.array([1000], dtype=np.int32), 3))


def test_short_readings_have_two_characters():
    assert decode_readings("MS", encode_readings(7, np.array([1234, 4095], dtype=np.int32), 2)).ranges.tolist() == [
        1234,
        4095,
    ]


def test_the_sensors_clock_begins_again_after_24_bits():
    body = encode_readings(CLOCK_SPAN + 5, np.zeros(1, dtype=np.int32), 3)
    assert decode_readings("MD", body).clock == 5


def test_every_time_is_read_as_it_was_written():
    for clock in (*range(5000), CLOCK_SPAN - 5):
        assert decode_readings("MD", encode_readings(clock, np.zeros(1, dtype=np.int32), 3)).clock == clock


@pytest.mark.parametrize("body", [b"", b"0N90", b"0N90X\n", b"0N90W\n0?", b"0N90W\n0?X0?Y0?ZH", b"0N90W\n00P\n"])
def test_incomplete_readings_are_refused(body):
    with pytest.raises(CodecError):
        decode_readings("MD", body)


@pytest.mark.parametrize("command", sorted(PARAMETERS))
def test_requests_come_back(command):
    request = Request(command, "1" * PARAMETERS[command], "text 16 long, ok")
    assert parse_request(request.line) == request


@pytest.mark.parametrize(
    ("line", "status"),
    [
        ("XX", "0E"),
        ("vv", "0E"),
        ("", "0E"),
        ("%XX", "0E"),
        ("TM", "0C"),
        ("GD000", "0C"),
        ("VV0", "0D"),
        ("VV;12345678901234567", "0G"),
        ("VV;a\x01", "0H"),
        ("VV;\xe4", "0H"),
    ],
)
def test_bad_requests_have_the_status_of_the_specification(line, status):
    with pytest.raises(RequestError, match=status):
        parse_request(line.encode("latin-1"))


def test_scan_requests_come_back():
    for request in (ScanRequest("GD", 0, 2, 0), ScanRequest("ME", 44, 725, 3, 2, 50, "hello")):
        assert ScanRequest.parse(parse_request(request.line), 1080) == request
    assert ScanRequest("GD", 0, 2, 0).line == b"GD0000000200"
    assert ScanRequest("MD", 0, 1080, 1, 0, 3).echo(2) == b"MD0000108001002"


@pytest.mark.parametrize(
    ("line", "status"),
    [
        ("GDx000001000", "01"),
        ("GD0000+01000", "02"),
        ("GD00000010 1", "03"),
        ("MD000000100 x00", "03"),
        ("MD0000001000x00", "06"),
        ("MD00000010000x0", "07"),
        ("GD0000108100", "04"),
        ("GD0010000900", "05"),
    ],
)
def test_bad_scan_requests_have_the_status_of_the_specification(line, status):
    with pytest.raises(RequestError, match=status):
        ScanRequest.parse(parse_request(line.encode()), 1080)


def test_a_last_cluster_may_be_smaller():
    assert [ScanRequest("GD", 0, 9, cluster).beams for cluster in (0, 1, 2, 3, 99)] == [10, 10, 5, 4, 1]


def test_parameters_come_back():
    sensor = Parameters("UST-10LX", 20, 30000, 1440, 0, 1080, 540, 2400)
    lines = encode_information(sensor.information).split(b"\n")[:-1]
    assert Parameters.of(decode_information(unseal_information(line) for line in lines)) == sensor


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [("ARES", None, "lack ARES"), ("AMIN", "many", "no number"), ("ARES", "0", "no sense"), ("AMAX", "-1", "no sense")],
)
def test_parameters_that_make_no_sense_are_refused(name, value, message):
    told = {"MODL": "X", "DMIN": "20", "DMAX": "1", "ARES": "9", "AMIN": "0", "AMAX": "1", "AFRT": "0", "SCAN": "600"}
    told = {key: text for key, text in {**told, name: value}.items() if text is not None}
    with pytest.raises(CodecError, match=message):
        Parameters.of(told)
