"""Payloads of ARCOS packets, both directions: the examples of the protocol and round trips."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import fields, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.pioneer.codec import (
    BAUD_CODES,
    MAX_PACKET,
    AuxData,
    Command,
    CommandNumber,
    Config,
    Encoders,
    Flags,
    Identity,
    PacketDecoder,
    PacketError,
    PacketType,
    Sip,
    checksum,
    decode_aux,
    decode_command,
    decode_config,
    decode_encoders,
    decode_identity,
    decode_sip,
    encode,
    encode_aux,
    encode_command,
    encode_config,
    encode_encoders,
    encode_identity,
    encode_sip,
    encode_sync,
    encode_wheels,
    is_sip,
    sync_number,
)

NUMBER = CommandNumber
U8, U16 = st.integers(0, 0xFF), st.integers(0, 0xFFFF)
I8, I16 = st.integers(-0x80, 0x7F), st.integers(-0x8000, 0x7FFF)
TAIL = (U8, U8, U8, U8, U8, U16, U8, I16, U16, I16, I8, U8)


def payload_of(packet: bytes) -> bytes:
    [payload] = PacketDecoder().feed(packet)
    return payload


@st.composite
def sips(draw: st.DrawFn) -> Sip:
    fixed = (st.booleans(), U16, U16, I16, I16, I16, U8, U8, U8, I16, U16, U8)
    sonar = draw(st.lists(st.tuples(U8, U16), max_size=53))
    told = draw(st.integers(0, len(TAIL)))
    tail = [draw(values) if i < told else None for i, values in enumerate(TAIL)]
    return Sip(*(draw(values) for values in fixed), tuple(sonar), *tail)


@pytest.mark.parametrize(
    ("packet", "wire"),
    [
        (encode_sync(0), "FA FB 03 00 00 00"),
        (encode_command(NUMBER.PULSE), "FA FB 03 00 00 00"),
        (encode_sync(1), "FA FB 03 01 00 01"),
        (encode_sync(2), "FA FB 03 02 00 02"),
        (encode_command(NUMBER.VEL, 250), "FA FB 06 0B 3B FA 00 05 3B"),
        (encode_command(NUMBER.VEL, -100), "FA FB 06 0B 1B 64 00 6F 1B"),
        (encode_command(NUMBER.RVEL, -10), "FA FB 06 15 1B 0A 00 1F 1B"),
        (encode_command(NUMBER.ENABLE, 1), "FA FB 06 04 3B 01 00 05 3B"),
        (encode_command(NUMBER.OPEN, 1), "FA FB 06 01 3B 01 00 02 3B"),
        (encode_command(NUMBER.CONFIG, 1), "FA FB 06 12 3B 01 00 13 3B"),
        (encode_command(NUMBER.CLOSE, 1), "FA FB 06 02 3B 01 00 03 3B"),
        (encode_command(NUMBER.TTY2, "abc"), "FA FB 08 2A 2B 03 61 62 63 8F EF"),
        (encode_wheels(-5, 5), "FA FB 06 20 1B FB 04 1B 1F"),
        (
            encode_identity(Identity("simrobot", "Pioneer", "p3at-sh")),
            "FA FB 1C 02 73 69 6D 72 6F 62 6F 74 00 50 69 6F 6E 65 65 72 00 70 33 61 74 2D 73 68 00 B3 14",
        ),
    ],
)
def test_packets_are_those_of_the_protocol(packet: bytes, wire: str) -> None:
    assert packet == bytes.fromhex(wire)


def test_the_odd_byte_of_a_payload_is_xored_into_the_low_byte_of_the_checksum() -> None:
    assert checksum(b"\x12\x34") == 0x1234
    assert checksum(b"\x12\x34\xff") == 0x1234 ^ 0xFF
    assert checksum(b"\xff\xff\x00\x02") == 0x0001


@given(U8, st.integers(-0xFFFF, 0xFFFF))
def test_an_integer_argument_travels_as_sign_and_magnitude(number: int, value: int) -> None:
    command = decode_command(payload_of(encode_command(number, value)))
    assert (command.number, command.argument) == (number, value)


@given(U8, st.binary(max_size=190))
def test_a_string_argument_travels_unchanged(number: int, text: bytes) -> None:
    command = decode_command(payload_of(encode_command(number, text)))
    assert (command.number, command.argument, command.string()) == (number, text, text)


@given(I8, I8)
def test_both_wheels_survive_passing_as_one_signed_number(left: int, right: int) -> None:
    assert decode_command(payload_of(encode_wheels(left, right))).halves() == (left, right)


def test_what_follows_the_length_of_a_string_is_ignored() -> None:
    assert decode_command(b"\x2a\x2b\x03abc\x00").argument == b"abc"


def test_several_values_after_one_type_stay_available() -> None:
    assert decode_command(b"\xe0\x3b" + bytes(range(12))).data == bytes(range(12))


@pytest.mark.parametrize("payload", [b"\x07", b"\x07\x3b", b"\x07\x3b\x01", b"\x07\x2b", b"\x07\x99\x01\x02"])
def test_an_argument_that_is_missing_or_unknown_is_none(payload: bytes) -> None:
    command = decode_command(payload)
    assert (command.number, command.argument, command.integer(7)) == (NUMBER.SETO, None, 7)


def test_arguments_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="does not fit"):
        encode_command(NUMBER.VEL, 0x10000)
    with pytest.raises(ValueError, match="too long"):
        encode_command(NUMBER.TTY2, "x" * 191)
    with pytest.raises(ValueError, match="empty"):
        decode_command(b"")
    with pytest.raises(ValueError, match="does not fit"):
        encode(bytes(196))


def test_only_a_single_byte_is_a_sync() -> None:
    assert [sync_number(payload_of(encode_sync(number))) for number in range(3)] == [0, 1, 2]
    assert sync_number(payload_of(encode_command(NUMBER.OPEN, 1))) is None
    assert sync_number(b"\x03") is None


def test_a_name_that_is_cut_short_is_empty_at_its_end() -> None:
    assert decode_identity(b"\x02robot\0Pioneer") == Identity("robot", "Pioneer", "")
    assert decode_identity(b"\x02") == Identity("", "", "")
    with pytest.raises(PacketError, match="SYNC2"):
        decode_identity(b"\x01")


@given(sips())
def test_a_sip_says_after_the_wire_what_it_said_before(sip: Sip) -> None:
    payload = payload_of(encode_sip(sip))
    assert is_sip(payload)
    assert decode_sip(payload) == sip


@given(sips(), st.integers(0, 40))
def test_a_sip_that_is_cut_anywhere_is_read_as_far_as_it_goes_or_refused(sip: Sip, cut: int) -> None:
    payload = payload_of(encode_sip(sip))[: -cut or None]
    if len(payload) < 20 + 3 * len(sip.sonar):
        with pytest.raises(PacketError):
            decode_sip(payload)
    else:
        read = decode_sip(payload)
        assert read[:13] == sip[:13]
        assert all(got in (None, sent) for got, sent in zip(read[13:], sip[13:], strict=True))


def test_the_fields_of_a_sip_lie_where_the_protocol_says() -> None:
    payload = bytearray(20 + 3 + 17)
    payload[0], payload[19], payload[20] = 0x33, 1, 7
    payload[1:3], payload[5:7] = b"\x34\x12", b"\xff\xff"
    payload[7:9], payload[9:11] = b"\x9c\xff", b"\x64\x00"
    payload[12], payload[13], payload[16:18] = 0b101, 0b10, b"\x21\x00"
    payload[21:23], payload[28:30] = b"\x88\x13", b"\x82\x00"
    payload[31:33] = b"\xf6\xff"
    sip = decode_sip(bytes(payload))
    assert sip.moving
    assert (sip.x, sip.heading, sip.left_velocity, sip.right_velocity) == (0x1234, -1, -100, 100)
    assert (sip.left_stalled, sip.rear_bumpers, sip.right_stalled, sip.front_bumpers) == (True, 0b10, False, 0b1)
    assert sip.flags == Flags.MOTORS_ENABLED | Flags.STOP_PRESSED
    assert sip.sonar == ((7, 5000),)
    assert (sip.battery_x10, sip.rotational_velocity) == (130, -10)


def test_position_counters_wrap_and_other_fields_are_refused_out_of_range() -> None:
    sip = decode_sip(payload_of(encode_sip(Sip(x=-5, y=65536 + 7))))
    assert (sip.x, sip.y) == (65531, 7)
    with pytest.raises(ValueError, match="out of range"):
        encode_sip(Sip(heading=40000))
    with pytest.raises(ValueError, match="does not fit a packet"):
        encode_sip(Sip(sonar=((0, 0),) * 60))


def test_a_whole_sip_with_all_sonar_stays_within_a_packet() -> None:
    assert len(encode_sip(Sip(sonar=tuple((i, 5000) for i in range(16))))) <= MAX_PACKET


def test_the_configuration_says_after_the_wire_what_it_said_before() -> None:
    config = Config(serial_number="ABC123", name="rover", drift_factor=-5, high_temperature=70, config_flags=1 << 31)
    packet = encode_config(config)
    assert decode_config(payload_of(packet)) == config
    assert len(packet) <= MAX_PACKET


def test_the_configuration_has_the_layout_of_the_protocol() -> None:
    payload = payload_of(encode_config(Config(serial_number="S", name="n")))
    texts = b"\x20Pioneer\0p3at-sh\0S\0"
    assert payload.startswith(texts + b"\x00" + (300).to_bytes(2, "little") + (1200).to_bytes(2, "little"))
    watchdog = len(texts) + 1 + 5 * 2 + len(b"n\0") + 3 + 2 + 2 + 1 + 2 + 2
    assert payload[watchdog : watchdog + 2] == (2000).to_bytes(2, "little")
    assert len(fields(Config)) == 67  # with the type, 68


@given(st.integers(0, 150))
def test_a_configuration_that_ends_early_is_zero_from_there(length: int) -> None:
    whole = Config(serial_number="ABC", name="rover")
    read = decode_config(payload_of(encode_config(whole))[: 1 + length])
    pairs = [(getattr(read, field.name), getattr(whole, field.name)) for field in fields(Config)]
    told = next((i for i, (got, sent) in enumerate(pairs) if got != sent), len(pairs))
    assert all(got in (0, "") for got, _ in pairs[told + 1 :])


def test_a_configuration_out_of_range_names_the_field() -> None:
    with pytest.raises(ValueError, match="watchdog"):
        encode_config(replace(Config(), watchdog=70000))
    with pytest.raises(PacketError, match="CONFIGpac"):
        decode_config(b"\x32")


def test_encoders_and_auxiliary_ports_survive_the_wire() -> None:
    assert decode_encoders(payload_of(encode_encoders(Encoders(-5, 1 << 30)))) == Encoders(-5, 1 << 30)
    for port, kind in ((1, PacketType.AUX1), (2, PacketType.AUX2), (3, PacketType.AUX3)):
        payload = payload_of(encode_aux(AuxData(port, b"* ok\r\n")))
        assert payload[0] == kind
        assert decode_aux(payload) == AuxData(port, b"* ok\r\n")
    with pytest.raises(PacketError):
        decode_encoders(b"\x90\x00")
    with pytest.raises(PacketError):
        decode_aux(b"\x32")
    with pytest.raises(ValueError, match="port 4"):
        encode_aux(AuxData(4, b""))


@given(st.binary(min_size=1, max_size=195))
def test_no_payload_breaks_a_decoder_with_anything_but_its_own_error(payload: bytes) -> None:
    assert isinstance(decode_command(payload), Command)
    for decode in (decode_sip, decode_config, decode_identity, decode_encoders, decode_aux):
        with suppress(PacketError):
            decode(payload)


def test_baud_codes_are_those_of_the_protocol() -> None:
    assert BAUD_CODES == {9600: 0, 19200: 1, 38400: 2, 57600: 3, 115200: 4}
    assert math.log2(Flags.STOP_PRESSED) == 5
