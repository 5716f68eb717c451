from __future__ import annotations

import socket
import threading
from collections import deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager

import numpy as np
import pytest
from camera_rigs import camera_spec, context, furnished_room, robot_spec, wait_for
from numpy.typing import NDArray

from drivers.camera import CameraDevice, open_sim
from drivers.camera.frame_message import Gone, NextRequest, PixelsRequest, header_message, read_frame, read_header
from drivers.camera.wire import Decoder, Kind, Message, encode
from sim.devices.camera import CameraServer
from sim.devices.plant import Plant
from sim.devices.shutter import Shutter
from sim.frame import SimFrame
from zavis_bt.errors import DeviceError
from zavis_bt.types import Pose2D, RgbdFrame


def look_at(frame: RgbdFrame) -> NDArray[np.uint8]:
    return frame.rgb


def measure(frame: RgbdFrame) -> NDArray[np.float32]:
    return frame.depth


class Gate:
    """Holds rendering up, and counts it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.rendered, self.open = 0, threading.Event()
        self.open.set()
        render = SimFrame._render_all

        def gated(frame: SimFrame):
            self.rendered += 1
            assert self.open.wait(20)
            return render(frame)

        monkeypatch.setattr(SimFrame, "_render_all", gated)


@pytest.fixture
def gate(monkeypatch) -> Gate:
    return Gate(monkeypatch)


@pytest.fixture
def plant() -> Iterator[Plant]:
    plant = Plant(furnished_room(), robot_spec(camera_spec()), Pose2D(1.0, 2.0))
    plant.start()
    yield plant
    plant.close()


@pytest.fixture
def server(plant, gate) -> Iterator[CameraServer]:
    server = CameraServer(plant)
    server.start()
    gate.rendered = 0  # but for the first picture, which it makes before anybody asks
    yield server
    gate.open.set()
    server.close()


@pytest.fixture
def camera(server) -> Iterator[CameraDevice]:
    camera = open_sim({"port": f"tcp://127.0.0.1:{server.port}"}, context())
    assert wait_for(camera.frame)
    yield camera
    camera.close()


@contextmanager
def line_to(server: CameraServer):
    """A client of our own: a function that asks and returns the answer."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=20) as line:
        decoder = Decoder()

        def ask(message: Message) -> Message:
            line.sendall(b"".join(encode(message)))
            while data := line.recv(65536):
                if messages := decoder.feed(data):
                    return messages[0]
            raise AssertionError("the server has hung up")

        yield ask


def passed(camera: CameraDevice, frames: int) -> bool:
    """Wait for so many further frames."""
    seen = {camera.frame().stamp}
    return wait_for(lambda: seen.add(camera.frame().stamp) or len(seen) > frames)


def mended(camera: CameraDevice) -> bool:
    """Wait until it has lost its line and brings frames again."""
    back = wait_for(lambda: camera.report().figures["lost"] != "0 times" and not camera.report().problems)
    return back and passed(camera, 1)


def test_nothing_is_rendered_for_frames_that_nobody_looks_at(camera, gate):
    assert passed(camera, 5)
    assert gate.rendered == 0
    assert camera.frame().annotations


def test_a_frame_is_rendered_when_looked_at_and_once(camera, gate, plant):
    frame = camera.frame()
    assert passed(camera, 3)
    np.testing.assert_array_equal(frame.rgb, plant.frame().rgb)
    before = gate.rendered
    np.testing.assert_allclose(frame.depth, plant.frame().depth, atol=0.00051)
    assert frame.rgb is frame.rgb
    assert gate.rendered == before + 1  # the plant's own


def test_frames_go_on_coming_while_pixels_are_rendered(camera, gate):
    gate.open.clear()
    with ThreadPoolExecutor(1) as pool:
        frame = camera.frame()
        look = pool.submit(lambda: frame.rgb)
        assert wait_for(lambda: gate.rendered)
        assert passed(camera, 3)
        assert not look.done()
        gate.open.set()
        assert look.result(20).shape == (48, 64, 3)


def test_several_threads_look_at_several_frames(camera):
    frames = [camera.frame()]
    assert wait_for(lambda: camera.frame() in frames or frames.append(camera.frame()) or len(frames) > 7)
    while len(frames) < 8:
        if camera.frame() is not frames[-1]:
            frames.append(camera.frame())
    with ThreadPoolExecutor(8) as pool:
        images = list(pool.map(lambda frame: frame.rgb, frames * 2))
    assert len({id(image) for image in images}) == 8
    for image in images:
        np.testing.assert_array_equal(image, images[0])


def test_a_client_with_a_second_line_is_one_client(camera, server):
    assert wait_for(lambda: server.clients == 1)
    camera.close()
    assert wait_for(lambda: server.clients == 0)


def test_a_frame_that_is_too_old_is_refused_in_one_line_and_the_camera_goes_on(camera, server):
    old = camera.frame()
    server._shutter._kept = deque(server._shutter._kept, maxlen=2)
    assert passed(camera, 4)
    with pytest.raises(
        DeviceError, match=r"frame \d+: is too old, the oldest that the server keeps is \d+ .*sooner"
    ) as e:
        look_at(old)
    assert "\n" not in str(e.value)
    with pytest.raises(DeviceError, match="too old"):
        measure(old)
    assert passed(camera, 2)
    assert camera.report().figures["lost"] == "0 times"


def test_a_line_that_is_lost_during_a_fetch_is_an_error_at_once_and_the_camera_comes_back(camera, server, gate, plant):
    gate.open.clear()
    with ThreadPoolExecutor(1) as pool:
        frame = camera.frame()
        look = pool.submit(lambda: frame.rgb)
        assert wait_for(lambda: gate.rendered)
        for line in tuple(server._lines):
            line.shutdown(socket.SHUT_RDWR)
        with pytest.raises(DeviceError, match=r"devices.camera: tcp://127.0.0.1:\d+: .*closed"):
            look.result(20)
        gate.open.set()
    assert mended(camera)
    assert camera.frame().rgb.shape == (48, 64, 3)


def test_the_loss_of_the_line_for_pixels_alone_is_noticed_and_mended(camera, server):
    (line,) = server._pixel_lines
    line.shutdown(socket.SHUT_RDWR)
    with pytest.raises(DeviceError, match="closed"):
        look_at(camera.frame())
    assert mended(camera)
    assert camera.frame().rgb.any()


def test_pixels_of_a_server_that_was_started_anew_are_not_taken_for_the_old_ones(camera, server, plant):
    old = camera.frame()
    server.close()
    again = CameraServer(plant, port=server.port)
    again.start()
    assert mended(camera)
    with pytest.raises(DeviceError):
        look_at(old)
    assert camera.frame().rgb.any()
    again.close()


def test_whoever_waits_too_long_is_told_so_and_the_late_answer_does_no_harm(camera, gate, monkeypatch):
    monkeypatch.setattr("drivers.camera.sim_pixels._PATIENCE", 0.3)
    gate.open.clear()
    late = camera.frame()
    with pytest.raises(DeviceError, match=r"frame \d+: its pixels did not come within 0.3 s"):
        look_at(late)
    monkeypatch.setattr("drivers.camera.sim_pixels._PATIENCE", 20.0)
    gate.open.set()
    assert passed(camera, 1)
    assert camera.frame().rgb.any()
    assert late.rgb.any()
    assert camera.report().figures["lost"] == "0 times"


def test_a_closed_camera_keeps_nobody_waiting(camera, gate):
    gate.open.clear()
    with ThreadPoolExecutor(2) as pool:
        frames = [camera.frame()]
        assert passed(camera, 1)
        frames.append(camera.frame())
        looks = [pool.submit(lambda frame=frame: frame.rgb) for frame in frames]
        assert wait_for(lambda: gate.rendered)
        camera.close()
        for look in looks:
            with pytest.raises(DeviceError, match="the connection is closed"):
                look.result(20)


def test_a_foreign_client_may_leave_pixels_and_fetch_them_over_one_line(server, gate):
    with line_to(server) as ask:
        header = read_frame(ask(header_message(Kind.NEXT, NextRequest(pixels="keep", annotations=True))))
        assert header.is_kept
        assert header.annotations
        assert gate.rendered == 0
        full = read_frame(ask(header_message(Kind.PIXELS, PixelsRequest(number=header.number, rgb="jpeg"))))
        assert (full.number, full.stamp, full.intrinsics) == (header.number, header.stamp, header.intrinsics)
        assert (full.rgb.encoding, full.depth.encoding) == ("jpeg", "raw")
        assert full.annotations is None
        gone = ask(header_message(Kind.PIXELS, PixelsRequest(number=10**6)))
        assert read_header(Gone, gone) == Gone(number=10**6, oldest=1)


def test_without_the_option_pixels_come_as_ever(server):
    with line_to(server) as ask:
        assert not read_frame(ask(Message(Kind.NEXT, {}))).is_kept


def test_pixels_that_were_fetched_are_not_kept_by_the_server(server):
    with line_to(server) as ask:
        for _ in range(3):
            number = read_frame(ask(header_message(Kind.NEXT, NextRequest(pixels="keep", wait=5.0)))).number
            ask(header_message(Kind.PIXELS, PixelsRequest(number=number)))
    assert not any("_pixels" in frame.__dict__ for _, frame in server._shutter._kept)


def test_the_shutter_keeps_the_last_pictures_and_no_more(plant):
    shutter = Shutter(plant.frame, rate=1e6)
    shutter._kept = deque(maxlen=5)
    assert (shutter.oldest, shutter.taken(1)) == (0, None)
    stamps = {}
    with ExitStack() as stack:
        stack.callback(shutter.close)
        for number in range(1, 9):
            known, frame = shutter.newer_than(number - 1, 5.0)
            stamps[known] = frame.stamp
    kept = {number: frame.stamp for number in range(1, 12) if (frame := shutter.taken(number)) is not None}
    assert kept == {number: stamps[number] for number in range(4, 9)}
    assert shutter.oldest == 4
