from __future__ import annotations

import socket
import threading
from contextlib import ExitStack, contextmanager

import numpy as np
import pytest
from camera_rigs import camera_spec, context, furnished_room, robot_spec, wait_for

from drivers.camera import AnnotatedFrame, open_sim
from drivers.camera.frame_message import NextRequest, header_message, read_frame
from drivers.camera.wire import Decoder, Kind, Message, encode
from sim.devices.camera import CameraServer
from sim.devices.plant import Plant
from sim.frame import instances_of
from sim.oracle import NamedOracle
from sim.perception import SimDetector, SimMatcher
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.types import Candidate, Pose2D, RgbdFrame

START = Pose2D(1.0, 2.0)


@pytest.fixture
def plant():
    plant = Plant(furnished_room(), robot_spec(camera_spec()), START)
    plant.start()
    yield plant
    plant.close()


@pytest.fixture
def server(plant):
    server = CameraServer(plant)
    server.start()
    yield server
    server.close()


@contextmanager
def opened(server: CameraServer, around=None, **settings):
    camera = open_sim({"port": f"tcp://127.0.0.1:{server.port}", **settings}, around or context())
    try:
        yield camera
    finally:
        camera.close()


@contextmanager
def line_to(server: CameraServer):
    """A client of our own: a function that sends bytes and returns the first message that comes back."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=20) as line:
        decoder = Decoder()

        def ask(data: bytes) -> Message | None:
            line.sendall(data)
            while data := line.recv(65536):
                if messages := decoder.feed(data):
                    return messages[0]
            return None

        yield ask


def request(**wishes) -> bytes:
    return b"".join(encode(header_message(Kind.NEXT, NextRequest(**wishes))))


def first_frame(camera) -> RgbdFrame:
    """Return the first frame, looked at, so that it outlives its camera."""
    assert wait_for(camera.frame)
    frame = camera.frame()
    assert frame.rgb.shape[:2] == frame.depth.shape
    return frame


@pytest.mark.parametrize("pixels", ["ask", "send"])
def test_frames_show_what_the_plants_camera_sees(server, plant, pixels):
    with opened(server, pixels=pixels) as camera:
        frame, true = first_frame(camera), plant.frame()
    assert isinstance(frame, AnnotatedFrame)
    assert frame.intrinsics == true.intrinsics
    np.testing.assert_array_equal(frame.rgb, true.rgb)
    np.testing.assert_allclose(frame.depth, true.depth, atol=0.00051)
    assert (frame.rgb.dtype, frame.depth.dtype) == (np.uint8, np.float32)


def test_annotations_are_the_ground_truth(server, plant):
    with opened(server) as camera:
        frame = first_frame(camera)
    assert instances_of(frame) == plant.frame().instances
    assert {view.id for view in instances_of(frame)} == {"sofa_1", "mug_1", "mug_2"}


@pytest.mark.parametrize("pixels", ["ask", "send"])
def test_compressed_images_say_the_same(server, plant, pixels):
    with opened(server, rgb="jpeg", depth="png", pixels=pixels) as camera:
        frame, true = first_frame(camera), plant.frame()
    np.testing.assert_allclose(frame.depth, true.depth, atol=0.00051)
    assert np.abs(frame.rgb.astype(int) - true.rgb).mean() < 6


def test_perception_judges_frames_off_the_wire_as_those_at_hand(server, plant):
    with opened(server) as camera:
        frame = first_frame(camera)
    true = plant.frame()
    same = RgbdFrame(frame.intrinsics, frame.transform_camera_to_map, frame.stamp, lambda: (frame.rgb, frame.depth))
    same.annotations = true.instances
    detector = SimDetector(["sofa"], np.random.default_rng(1))
    matcher = SimMatcher(lambda a, b: float(a == b), np.random.default_rng(2))
    assert detector.detect(frame) == detector.detect(same)
    boxes = [view.box for view in true.instances]
    np.testing.assert_array_equal(matcher.match(frame, boxes, ["red mug"]), matcher.match(same, boxes, ["red mug"]))


def test_an_oracle_that_knows_only_the_text_knows_the_target(server):
    with opened(server) as camera:
        frame = first_frame(camera)
    boxes = {view.id: view.box for view in instances_of(frame)}
    candidates = [Candidate("mug", 30.0, boxes[name], (0.0, 0.0, 0.0), frame) for name in ("mug_2", "mug_1", "sofa_1")]
    synonyms = {frozenset({"couch", "sofa"}): 0.9}

    def similarity(a: str, b: str) -> float:
        return 1.0 if a == b else synonyms.get(frozenset({a, b}), 0.0)

    for text, accepted in (("the red mug", 1), ("mug", 0), ("couch", 2), ("red couch", None), ("plant", None)):
        assert NamedOracle(text, similarity).ask(text, candidates).result().accepted == accepted


def test_without_annotations_simulated_perception_says_what_it_needs(server):
    with opened(server, annotations=False) as camera:
        frame = first_frame(camera)
    assert not isinstance(frame, AnnotatedFrame)
    with pytest.raises(InputError, match=r"only judge frames of the simulated camera.*driver: sim"):
        instances_of(frame)


def test_stamps_are_on_the_clients_clock(server, plant):
    around = context()
    with opened(server, around) as camera:
        assert wait_for(lambda: camera.report().figures.get("rate"))
        assert wait_for(lambda: len(camera._stamps) > 20)
        frame, now = camera.frame(), around.clock.now()
    assert frame.transform_camera_to_map[0, 3] == frame.stamp
    assert frame.stamp <= now
    offset = camera._source._offset(0.0)
    assert offset == pytest.approx(around.clock.now() - plant.now, abs=0.2)


def test_a_frozen_camera_delivers_nothing_new_and_goes_on_when_thawed(server):
    with opened(server) as camera:
        first_frame(camera)
        server.freeze()
        wait_for(lambda: False, 0.3)
        old = camera.frame()
        assert not wait_for(lambda: camera.frame() is not old, 0.5)
        assert not camera.report().problems
        server.thaw()
        assert wait_for(lambda: camera.frame() is not old)
        assert camera.report().figures["lost"] == "0 times"


def test_after_the_server_has_gone_and_come_back_frames_go_on(server, plant):
    with opened(server) as camera:
        first_frame(camera)
        server.close()
        assert wait_for(lambda: camera.report().problems)
        old = camera.frame()
        again = CameraServer(plant, port=server.port)
        again.start()
        assert wait_for(lambda: camera.frame() is not old)
        assert not camera.report().problems
        again.close()


def test_several_clients_are_served(server):
    with opened(server) as one, opened(server) as two:
        first, second = first_frame(one), first_frame(two)
        assert wait_for(lambda: one.frame() is not first and two.frame() is not second)


def test_one_client_too_many_is_told_so(server):
    with ExitStack() as lines:
        for _ in range(16):
            lines.enter_context(socket.create_connection(("127.0.0.1", server.port)))
        assert wait_for(lambda: server.clients == 16)
        with pytest.raises(DeviceError, match="16 connections are open already"):
            open_sim({"port": f"tcp://127.0.0.1:{server.port}"}, context())
    assert wait_for(lambda: server.clients == 0)
    with opened(server) as camera:
        first_frame(camera)


def test_nobody_gets_a_frame_twice_or_more_of_them_than_the_camera_takes(server):
    begin, numbers = server._plant.now, [0]
    with line_to(server) as ask:
        while len(numbers) < 7:
            answer = ask(request(after=numbers[-1], wait=5.0))
            assert answer.kind == Kind.FRAME
            numbers.append(read_frame(answer).number)
    assert numbers == sorted(set(numbers))
    assert server._plant.now - begin >= 0.8 * (numbers[-1] - 1) / 20.0


def test_nothing_is_rendered_unless_asked_for(server, plant):
    taken = []
    take = plant.frame
    server._shutter._take = lambda: taken.append(1) or take()
    assert not wait_for(lambda: taken, 0.2)
    with line_to(server) as ask:
        ask(request())
    assert taken == [1]


def test_without_waiting_the_answer_comes_at_once(server):
    server.freeze()
    with line_to(server) as ask:
        answer = ask(request(wait=0.0))
    assert answer.kind == Kind.NOTHING_NEW
    assert answer.header["number"] == 0


def test_garbage_is_passed_over(server):
    rng = np.random.default_rng(4)
    with line_to(server) as ask:
        answer = ask(rng.integers(0, 256, 50_000, dtype=np.uint8).tobytes() + request())
    assert answer.kind == Kind.FRAME


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (Message(Kind.NEXT, {"color": 1}), "color"),
        (Message(Kind.PIXELS, {"number": 0}), "number"),
        (Message(Kind.PIXELS, {"rgb": "raw"}), "number"),
        (Message(Kind.IDENTIFY, {"purpose": "tea"}), "purpose"),
        (Message(0x33, {}), "kind 51 are unknown"),
        (Message(Kind.NEXT, {}, version=2), "version 2"),
    ],
)
def test_what_is_no_request_is_answered_with_what_is_wrong(server, message, words):
    with line_to(server) as ask:
        answer = ask(b"".join(encode(message)))
        assert answer.kind == Kind.ERROR
        assert words in answer.header["message"]
        assert ask(request()).kind == Kind.FRAME


def test_closing_ends_all_threads_and_may_be_done_twice(server, plant):
    with line_to(server) as ask:
        ask(request())
        server.close()
        server.close()
    names = {thread.name for thread in threading.enumerate()}
    assert not {name for name in names if name.startswith("camera")}
    assert not plant.controllers


def test_a_port_in_use_is_said_so(server, plant):
    with pytest.raises(DeviceError, match="choose another port"):
        CameraServer(plant, port=server.port)


@contextmanager
def answering(answers: dict[int, list[Message]], hold_open: bool = True):
    """A server that gives these answers to requests of a kind, in turn."""
    listener = socket.create_server(("127.0.0.1", 0))
    listener.settimeout(20)

    def serve() -> None:
        with listener, listener.accept()[0] as line:
            decoder = Decoder()
            while data := line.recv(65536):
                for asked in decoder.feed(data):
                    if answers.get(asked.kind):
                        line.sendall(b"".join(encode(answers[asked.kind].pop(0))))

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    yield f"tcp://127.0.0.1:{listener.getsockname()[1]}"
    thread.join(timeout=20)


IDENTITY = Message(Kind.IDENTITY, {"model": "x", "firmware": "", "serial": "", "rate": 10.0})


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (Message(Kind.IDENTITY, {"model": "x"}, version=9), "speaks version 9"),
        (Message(Kind.ERROR, {"message": "too hot"}), "too hot"),
        (Message(Kind.IDENTITY, {}), "a message that is none: model"),
        (Message(0x42, {}), "unknown kind 66"),
    ],
)
def test_a_server_that_answers_wrongly_is_no_camera(answer, words):
    with answering({Kind.IDENTIFY: [answer]}) as port, pytest.raises(DeviceError, match=words):
        open_sim({"port": port}, context())


def test_a_frame_that_is_none_is_a_loss():
    with answering({Kind.IDENTIFY: [IDENTITY], Kind.NEXT: [Message(Kind.FRAME, {"number": 1})]}) as port:
        camera = open_sim({"port": port, "pixels": "send"}, context())
        assert wait_for(lambda: camera.report().figures["lost"] != "0 times")
        camera.close()
        assert camera.frame() is None


def test_pixels_that_a_server_keeps_unasked_are_missed_in_one_line():
    images = {"rgb": {"encoding": "raw", "size": 0}, "depth": {"encoding": "raw", "size": 0}}
    intrinsics = {"width": 4, "height": 3, "fx": 5.0, "fy": 5.0, "cx": 2.0, "cy": 1.5}
    header = {"number": 1, "stamp": 0.5, "now": 0.5, "intrinsics": intrinsics, **images}
    with answering({Kind.IDENTIFY: [IDENTITY], Kind.NEXT: [Message(Kind.FRAME, header)]}) as port:
        camera = open_sim({"port": port, "pixels": "send"}, context())
        assert wait_for(camera.frame)
        with pytest.raises(DeviceError, match=r"tcp://127.0.0.1:\d+: the raw image has 0 bytes"):
            np.asarray(camera.frame().rgb)
        camera.close()


def test_nobody_there_is_said_with_the_remedy():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    with pytest.raises(DeviceError, match=r"devices.camera: tcp://127.0.0.1:\d+: nothing listens there .*sim serve"):
        open_sim({"port": f"tcp://127.0.0.1:{port}"}, context())
