from __future__ import annotations

import contextlib
import importlib
import json
import re
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.camera import wire
from drivers.camera.frame_message import (
    Annotation,
    Gone,
    IdentifyRequest,
    NextRequest,
    PixelsRequest,
    WireFrame,
    frame_message,
    header_message,
    read_frame,
    read_header,
)
from drivers.camera.pixels import WireImage, decode_pixels, encode_depth, encode_rgb
from drivers.camera.wire import Decoder, Kind, Message, WireError, encode
from zavis_bt.types import Box, CameraIntrinsics

INTRINSICS = CameraIntrinsics(16, 12, 20.5, 21.0, 8.25, 6.0)
MUG = Annotation("mug_1", "mug", "red", False, Box(1.5, 2.0, 3.0, 4.25), Box(-1.0, 2.0, 3.0, 9.0), 0.5, 12.25, 1.1)
SOFA = Annotation("sofa_1", "sofa", None, True, Box(0.0, 0.0, 9.0, 9.0), Box(0.0, 0.0, 9.0, 9.0), 1.0, 81.0, 2.5)


def images() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    rgb = np.zeros((12, 16, 3), np.uint8) + np.arange(0, 160, 10, dtype=np.uint8)[:, None]
    depth = rng.uniform(0.3, 9.0, (12, 16)).astype(np.float32)
    depth[3:5, 3:5] = 0.0
    return rgb, depth


def frame(number: int = 7, rgb: str = "raw", depth: str = "raw") -> WireFrame:
    pictures = images()
    return WireFrame(
        number, 12.5, 12.625, INTRINSICS, encode_rgb(pictures[0], rgb), encode_depth(pictures[1], depth), (MUG, SOFA)
    )


def kept(number: int = 7) -> WireFrame:
    """A frame whose images stay with the server."""
    return replace(frame(number), rgb=WireImage("jpeg", b""), depth=WireImage("raw", b""))


def stream(*messages: Message) -> bytes:
    return b"".join(piece for message in messages for piece in encode(message))


headers = st.dictionaries(
    st.text(max_size=8),
    st.recursive(
        st.none()
        | st.booleans()
        | st.integers()
        | st.floats(allow_nan=False, allow_infinity=False)
        | st.text(max_size=8),
        lambda inner: st.lists(inner, max_size=3),
        max_leaves=5,
    ),
    max_size=4,
)
messages = st.builds(Message, st.integers(0, 255), headers, st.binary(max_size=200), st.integers(0, 255))


@settings(deadline=None)
@given(st.lists(messages, max_size=4), st.lists(st.integers(1, 60), min_size=1))
def test_messages_survive_the_wire_however_it_cuts_them(sent, cuts):
    data, decoder, received, at, turn = stream(*sent), Decoder(), [], 0, 0
    while at < len(data):
        size = cuts[turn % len(cuts)]
        received += decoder.feed(data[at : at + size])
        at, turn = at + size, turn + 1
    assert received == sent
    assert decoder.pending == decoder.dropped == 0


@settings(deadline=None)
@given(st.binary(max_size=300), messages, messages)
def test_messages_are_found_between_garbage(garbage, one, two):
    decoder = Decoder()
    received = decoder.feed(garbage + stream(one) + garbage + stream(two))
    assert received == [one, two]
    assert decoder.dropped == 2 * len(garbage)


@settings(deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 255))
def test_a_damaged_message_is_dropped_and_the_next_is_found(place, flip):
    first, second = stream(frame_message(frame())), stream(frame_message(frame(8)))
    damaged = bytearray(first)
    damaged[place % len(first)] ^= flip
    received = Decoder().feed(bytes(damaged) + second)
    assert [message.header["number"] for message in received][-1] == 8
    assert len(received) <= 2


def test_a_message_inside_a_damaged_one_is_found():
    inner = stream(Message(Kind.NEXT, {}))
    outer = bytearray(stream(Message(Kind.FRAME, {}, inner)))
    outer[wire.PREFIX] ^= 1
    assert [message.kind for message in Decoder().feed(bytes(outer))] == [Kind.NEXT]


def mutated(rng: np.random.Generator, data: bytes) -> bytes:
    """Return the bytes with a few changed, lost or doubled."""
    changed = bytearray(data)
    for _ in range(rng.integers(1, 5)):
        place = int(rng.integers(len(changed)))
        match rng.integers(3):
            case 0:
                changed[place] = int(rng.integers(256))
            case 1:
                del changed[place : place + int(rng.integers(1, 9))]
            case _:
                changed[place:place] = changed[place : place + int(rng.integers(1, 99))]
    return bytes(changed)


def feed_noise(rng: np.random.Generator, decoder: Decoder, good: bytes, asked: bytes, total: int) -> None:
    fed = 0
    while fed < total:
        random = rng.integers(0, 256, int(rng.integers(1, 3000)), dtype=np.uint8).tobytes()
        data = random if rng.random() < 0.5 else mutated(rng, good if rng.random() < 0.5 else asked)
        for message in decoder.feed(data):
            for model in (PixelsRequest, Gone, IdentifyRequest):
                with contextlib.suppress(WireError):
                    read_header(model, message)
            with contextlib.suppress(WireError):
                found = read_frame(message)
                decode_pixels(found.rgb, found.depth, found.intrinsics)
        assert decoder.pending <= len(good)
        fed += len(data)


def test_a_million_random_and_mutated_bytes_do_no_harm():
    rng, decoder, good = np.random.default_rng(3), Decoder(), stream(frame_message(frame()))
    asked = stream(frame_message(kept(2)), header_message(Kind.PIXELS, PixelsRequest(number=2)))
    asked += stream(header_message(Kind.GONE, Gone(number=2, oldest=5)))
    decoder.feed(good)
    importlib.import_module("cv2")  # loaded at its first use, which would count as held
    feed_noise(rng, decoder, good, asked, 100_000)
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    feed_noise(rng, decoder, good, asked, 900_000)
    held = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert held < 90_000
    assert [message.header["number"] for message in decoder.feed(good + good)][-2:] == [7, 7]


@settings(max_examples=50, deadline=None)
@given(headers, st.binary(max_size=40))
def test_whatever_a_header_says_a_frame_is_read_or_refused(header, body):
    full = dict(frame_message(frame()).header) | header
    for candidate in (header, full):
        with pytest.raises(WireError):
            read_frame(Message(Kind.FRAME, candidate, body))


def test_a_length_beyond_the_limits_is_not_waited_for():
    prefix = wire._FIXED.pack(wire.MAGIC, 1, Kind.FRAME, 0, 10, wire.MAX_BODY + 1, 0)
    decoder = Decoder()
    decoder.feed(prefix + wire._CHECK.pack(wire.crc32(prefix)) + b"x" * 100)
    assert decoder.pending < 4
    with pytest.raises(ValueError, match="at most"):
        encode(Message(Kind.FRAME, {}, bytes(wire.MAX_BODY + 1)))


def test_a_header_that_is_no_object_is_dropped():
    fixed = wire._FIXED.pack(wire.MAGIC, 1, Kind.NEXT, 0, 2, 0, wire.crc32(b"[]"))
    decoder = Decoder()
    assert decoder.feed(fixed + wire._CHECK.pack(wire.crc32(fixed)) + b"[]") == []
    assert decoder.feed(stream(Message(Kind.NEXT, {}))) == [Message(Kind.NEXT, {})]


@pytest.mark.parametrize("rgb", ["raw", "jpeg"])
@pytest.mark.parametrize("depth", ["raw", "png"])
def test_a_frame_comes_out_as_it_went_in(rgb, depth):
    (message,) = Decoder().feed(stream(frame_message(frame(rgb=rgb, depth=depth))))
    received = read_frame(message)
    assert received == frame(rgb=rgb, depth=depth)
    colours, distances = decode_pixels(received.rgb, received.depth, received.intrinsics)
    true_colours, true_distances = images()
    assert colours.dtype == np.uint8
    assert distances.dtype == np.float32
    assert np.abs(colours.astype(int) - true_colours).max() <= (0 if rgb == "raw" else 12)
    np.testing.assert_allclose(distances, true_distances, atol=0.00051)
    assert (distances[3:5, 3:5] == 0).all()


def test_a_kept_frame_has_everything_but_its_images():
    (message,) = Decoder().feed(stream(frame_message(kept())))
    received = read_frame(message)
    assert message.body == b""
    assert received == kept()
    assert received.is_kept
    assert not frame().is_kept
    assert (received.rgb.encoding, received.depth.encoding) == ("jpeg", "raw")


def test_a_frame_with_one_image_of_two_is_refused():
    for half in (replace(frame(), rgb=WireImage("raw", b"")), replace(frame(), depth=WireImage("raw", b""))):
        with pytest.raises(WireError, match="0 bytes"):
            read_frame(frame_message(half))


@pytest.mark.parametrize("encoding", ["raw", "jpeg"])
def test_images_that_are_not_there_cannot_be_decoded(encoding):
    with pytest.raises(WireError, match="image"):
        decode_pixels(WireImage(encoding, b""), WireImage("raw", b""), INTRINSICS)


@settings(max_examples=60, deadline=None)
@given(headers)
def test_whatever_a_header_says_it_is_a_request_or_refused(header):
    for model, sound in ((PixelsRequest, {"number": 3}), (Gone, {"number": 3, "oldest": 4}), (IdentifyRequest, {})):
        assert read_header(model, Message(Kind.PIXELS, sound)).model_dump().items() >= sound.items()
        if header:
            with pytest.raises(WireError):
                read_header(model, Message(Kind.PIXELS, sound | header))


def test_colours_keep_their_order_in_jpeg():
    red = np.zeros((16, 16, 3), np.uint8)
    red[:, :, 0] = 250
    image, depth = encode_rgb(red, "jpeg"), encode_depth(np.ones((16, 16), np.float32), "png")
    rgb, _ = decode_pixels(image, depth, CameraIntrinsics(16, 16, 9.0, 9.0, 8.0, 8.0))
    assert rgb[8, 8, 0] > 200
    assert rgb[8, 8, 2] < 50


def test_depth_too_far_for_sixteen_bits_is_no_reading():
    image = encode_depth(np.array([[65.5, 65.6]], np.float32), "raw")
    assert np.frombuffer(image.data, "<u2").tolist() == [65500, 0]


def test_a_damaged_compressed_image_is_refused():
    image = encode_rgb(images()[0], "jpeg")
    broken = type(image)("jpeg", b"\0" * 50)
    with pytest.raises(WireError, match="jpeg image is damaged"):
        decode_pixels(broken, encode_depth(images()[1], "raw"), INTRINSICS)


def test_sizes_that_do_not_fit_the_body_are_refused():
    message = frame_message(frame())
    with pytest.raises(WireError, match="body"):
        read_frame(Message(message.kind, message.header, message.body[:-1]))
    header = {**message.header, "rgb": {"encoding": "raw", "size": 5}}
    with pytest.raises(WireError, match="raw it has 576"):
        read_frame(Message(message.kind, header, message.body))


def test_a_request_says_what_is_wanted_and_nothing_else():
    request = NextRequest(after=3, wait=0.25, rgb="jpeg", annotations=True)
    assert read_header(NextRequest, header_message(Kind.NEXT, request)) == request
    with pytest.raises(WireError, match="colour"):
        read_header(NextRequest, Message(Kind.NEXT, {"colour": True}))
    with pytest.raises(WireError, match="wait"):
        read_header(NextRequest, Message(Kind.NEXT, {"wait": 1e9}))


def test_the_documented_example_is_what_is_sent():
    text = (Path(__file__).parents[2] / "docs" / "camera_protocol.md").read_text()
    example = text[text.index("## Example") :]
    blocks = re.findall(r"^```(json)?\n(.*?)^```$", example, re.MULTILINE | re.DOTALL)
    hexadecimal = [re.findall(r"^(?:[0-9a-f]{2} ?)+", block, re.MULTILINE) for kind, block in blocks if not kind]
    found = [message for lines in hexadecimal for message in Decoder().feed(bytes.fromhex("".join(lines)))]
    kinds = [Kind.IDENTIFY, Kind.NEXT, Kind.NOTHING_NEW, Kind.FRAME, Kind.NEXT, Kind.FRAME, Kind.PIXELS, Kind.GONE]
    assert [message.kind for message in found] == kinds
    assert [json.loads(block) for kind, block in blocks if kind] == [found[3].header]
    last = read_frame(found[3])
    rgb, depth = decode_pixels(last.rgb, last.depth, last.intrinsics)
    assert rgb.tolist() == [[[255, 0, 0], [0, 0, 255]]]
    assert depth.tolist() == [[1.5, 0.0]]
    assert read_header(NextRequest, found[4]) == NextRequest(after=17, pixels="keep")
    assert read_frame(found[5]).is_kept
    assert read_header(PixelsRequest, found[6]) == PixelsRequest(number=18)
    assert read_header(Gone, found[7]) == Gone(number=18, oldest=31)
