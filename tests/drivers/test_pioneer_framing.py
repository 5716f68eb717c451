"""Finding packets in whatever comes down the line."""

from __future__ import annotations

import random
import time

from hypothesis import given
from hypothesis import strategies as st

from drivers.pioneer.codec import MAX_PACKET, PacketDecoder, Sip, decode_sip, encode, encode_sip, encode_sync

payloads = st.binary(min_size=1, max_size=195)
# noise without the first header byte cannot begin a packet that would swallow the next one
plain_noise = st.binary(max_size=40).map(lambda noise: noise.replace(b"\xfa", b"\xf9"))
header_noise = st.lists(st.sampled_from([b"\xfa", b"\xfb", b"\xfa\xfb", b"\x03", b"\xff", b"\x00", b"\x25"])).map(
    b"".join
)


@given(st.lists(st.tuples(plain_noise, payloads)))
def test_every_packet_between_noise_is_found(parts: list[tuple[bytes, bytes]]) -> None:
    decoder = PacketDecoder()
    stream = b"".join(noise + encode(payload) for noise, payload in parts)
    assert decoder.feed(stream) == [payload for _, payload in parts]
    assert decoder.skipped == sum(len(noise) for noise, _ in parts)


@given(st.one_of(st.binary(max_size=600), header_noise), st.integers(1, 50), st.lists(payloads, max_size=4))
def test_the_pieces_in_which_bytes_arrive_do_not_matter(noise: bytes, piece: int, packets: list[bytes]) -> None:
    stream = noise + b"".join(encode(payload) for payload in packets)
    whole, pieces = PacketDecoder(), PacketDecoder()
    at_once = whole.feed(stream)
    one_by_one = [payload for at in range(0, len(stream), piece) for payload in pieces.feed(stream[at : at + piece])]
    assert at_once == one_by_one
    assert (whole.skipped, whole.checksum_errors, whole.pending) == (
        pieces.skipped,
        pieces.checksum_errors,
        pieces.pending,
    )


@given(st.one_of(st.binary(max_size=600), header_noise), payloads)
def test_a_packet_behind_any_noise_is_found_at_the_latest_after_a_silence(noise: bytes, payload: bytes) -> None:
    decoder = PacketDecoder()
    assert payload in decoder.feed(noise + encode(payload)) + decoder.expire()
    assert decoder.pending == 0


@given(st.binary(max_size=3000))
def test_every_byte_is_accounted_for_and_little_is_remembered(data: bytes) -> None:
    decoder = PacketDecoder()
    found = decoder.feed(data)
    assert sum(len(payload) + 5 for payload in found) + decoder.skipped + decoder.pending == len(data)
    assert decoder.pending < MAX_PACKET


def test_a_header_byte_before_a_header_is_noise() -> None:
    decoder = PacketDecoder()
    assert decoder.feed(b"\xfa" + encode_sync(1)) == [b"\x01"]
    assert decoder.feed(b"\x00\xfa") == []
    assert decoder.feed(encode_sync(2)) == [b"\x02"]


def test_after_a_bad_checksum_the_search_goes_on_inside_the_packet() -> None:
    decoder = PacketDecoder()
    false = b"\xfa\xfb\x14" + encode_sync(0) + encode_sync(1)
    assert decoder.feed(false + bytes(8)) == [b"\x00", b"\x01"]
    assert decoder.checksum_errors == 1


def test_lengths_that_no_packet_has_are_not_waited_for() -> None:
    decoder = PacketDecoder()
    for length in (0, 1, 2, 198, 255):
        assert decoder.feed(b"\xfa\xfb" + bytes((length,)) + encode_sync(0)) == [b"\x00"]


def test_a_packet_that_stops_coming_gives_way_to_those_inside_it() -> None:
    decoder = PacketDecoder()
    assert decoder.feed(b"\xfa\xfb\xc0" + encode_sync(0) + encode_sync(1)[:-1]) == []
    assert decoder.expire() == [b"\x00"]
    assert decoder.pending == 0
    assert decoder.feed(encode_sync(2)) == [b"\x02"]


def test_random_and_mutated_bytes_never_cost_the_next_packet() -> None:
    source, decoder = random.Random(5), PacketDecoder()
    good = encode_sip(Sip(x=77, sonar=((1, 2), (3, 4))))
    deadline = time.monotonic() + 2.0
    while time.monotonic() < deadline and decoder.skipped < 300_000:
        noise = bytearray(source.randbytes(source.randrange(400)) + good * source.randrange(3))
        for _ in range(source.randrange(4) if noise else 0):
            noise[source.randrange(len(noise))] = source.choice((0xFA, 0xFB, 0x00, 0xFF))
        for payload in decoder.feed(bytes(noise)) + decoder.expire():
            assert len(payload) <= MAX_PACKET
        [payload] = decoder.feed(good)
        assert decode_sip(payload).x == 77
