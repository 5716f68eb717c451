from __future__ import annotations

import sys
import time
from types import SimpleNamespace as Plain

import numpy as np
import pytest
from camera_rigs import camera_spec, context, wait_for

from drivers.camera import CameraDevice, open_realsense
from drivers.camera.realsense_source import RealSenseSettings, RealSenseSource
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.types import CameraIntrinsics

WIDTH, HEIGHT = 64, 48


class Info:
    """A camera as pyrealsense2 lists it."""

    def __init__(self, serial: str) -> None:
        self.values = {"name": "Intel RealSense D435", "serial_number": serial, "firmware_version": "5.16.0.1"}

    def supports(self, key: str) -> bool:
        return key in self.values

    def get_info(self, key: str) -> str:
        return self.values[key]

    def first_depth_sensor(self) -> Plain:
        return Plain(get_depth_scale=lambda: 0.0005)


class Library:
    """As much of pyrealsense2 as there is of it in the driver, with cameras that can be unplugged."""

    camera_info = Plain(
        name="name",
        serial_number="serial_number",
        firmware_version="firmware_version",
        usb_type_descriptor="usb_type_descriptor",
    )
    stream = Plain(color="color", depth="depth")
    format = Plain(rgb8="rgb8", z16="z16")
    timestamp_domain = Plain(hardware_clock="hardware", system_time="system")

    def __init__(self, *serials: str) -> None:
        self.cameras = [Info(serial) for serial in serials]
        self.domain, self.age, self.failure = "system", 0.03, ""
        self.config = Plain
        self.streams: list[tuple] = []
        self.running: list[Library] = []

    def context(self) -> Plain:
        return Plain(query_devices=lambda: list(self.cameras))

    def pipeline(self, devices: Plain) -> Library:
        return self

    def start(self, config: Config) -> Library:
        if self.failure:
            raise RuntimeError(self.failure)
        self.streams, self.camera = config.streams, config.serial
        self.running.append(self)
        return self

    def stop(self) -> None:
        self.running.pop()

    def get_stream(self, stream: str) -> Library:
        return self

    def as_video_stream_profile(self) -> Plain:
        model = Plain(width=WIDTH, height=HEIGHT, fx=55.0, fy=56.0, ppx=31.5, ppy=23.25)
        return Plain(intrinsics=model)

    def get_device(self) -> Info:
        return Info(self.camera)

    def try_wait_for_frames(self, timeout_ms: int) -> tuple[bool, Library | None]:
        time.sleep(0.005)
        if self.failure:
            raise RuntimeError(self.failure)
        return bool(self.cameras), self

    def align(self, to: str) -> Library:
        assert to == "color"
        return self

    def process(self, frames: Library) -> Library:
        return frames

    def get_timestamp(self) -> float:
        return 1000 * (time.time() - self.age)

    def get_frame_timestamp_domain(self) -> str:
        return self.domain

    def get_color_frame(self) -> Plain:
        return Plain(get_data=lambda: np.full((HEIGHT, WIDTH, 3), 77, np.uint8))

    def get_depth_frame(self) -> Plain:
        counts = np.full((HEIGHT, WIDTH), 3000, np.uint16)
        counts[0], counts[1] = 100, 60_000  # nearer and farther than the robot's camera is taken to measure
        return Plain(get_data=lambda: counts)


class Config:
    def __init__(self) -> None:
        self.streams: list[tuple] = []

    def enable_device(self, serial: str) -> None:
        self.serial = serial

    def enable_stream(self, *stream: object) -> None:
        self.streams.append(stream)


@pytest.fixture
def library():
    library = Library("111", "222")
    library.config = Config
    return library


def source(library: Library, **settings) -> RealSenseSource:
    return RealSenseSource(
        RealSenseSettings(**settings), context(camera_spec(WIDTH, HEIGHT)), library, library.context()
    )


@pytest.fixture
def device(library):
    around = context(camera_spec(WIDTH, HEIGHT))
    camera = CameraDevice(RealSenseSource(RealSenseSettings(serial="222"), around, library, library.context()), around)
    yield camera
    camera.close()


def test_frames_have_the_devices_intrinsics_and_depth_in_metres(device):
    assert wait_for(device.frame)
    frame = device.frame()
    assert frame.intrinsics == CameraIntrinsics(WIDTH, HEIGHT, 55.0, 56.0, 32.0, 23.75)
    assert frame.rgb[5, 5].tolist() == [77, 77, 77]
    np.testing.assert_allclose(frame.depth[2:], 1.5)
    assert frame.depth.dtype == np.float32
    assert (frame.depth[:2] == 0).all()


def test_the_camera_of_the_serial_number_is_asked_for_colour_and_depth(library, device):
    assert library.camera == "222"
    assert library.streams == [("color", WIDTH, HEIGHT, "rgb8", 30), ("depth", 0, 0, "z16", 30)]
    report = device.report()
    assert (report.model, report.firmware, report.serial) == ("Intel RealSense D435", "5.16.0.1", "222")
    assert report.figures["depth unit"] == "0.5 mm"


def test_stamps_say_when_the_images_were_taken(device, library):
    assert wait_for(lambda: len(device._stamps) > 3)
    taken, read = zip(*device._stamps, strict=True)
    assert min(np.subtract(read, taken)) == pytest.approx(library.age, abs=0.025)


def test_stamps_of_the_cameras_own_clock_are_put_on_ours(device, library):
    library.domain, library.age = "hardware", -5000.0
    before = len(device._stamps)
    assert wait_for(lambda: len(device._stamps) > before + 5)
    taken, read = zip(*device._stamps, strict=True)
    assert 0.0 <= read[-1] - taken[-1] < 0.5


def test_images_come_at_the_rate_of_the_robots_camera(device):
    assert wait_for(lambda: len(device._stamps) > 10)
    stamps = [taken for taken, _ in device._stamps]
    assert (stamps[-1] - stamps[0]) / (len(stamps) - 1) > 0.8 / 20.0


def test_an_unplugged_camera_is_missed_and_found_again(device, library, monkeypatch):
    monkeypatch.setattr("drivers.camera.realsense_source._SILENCE", 0.1)
    assert wait_for(device.frame)
    gone, library.cameras = library.cameras, []
    assert wait_for(lambda: device.report().problems)
    assert "no RealSense camera is connected" in device.report().problems[0]
    old = device.frame()
    library.cameras = gone
    assert wait_for(lambda: device.frame() is not old)
    assert not device.report().problems


def test_a_failure_of_the_library_is_a_loss(device, library):
    assert wait_for(device.frame)
    library.failure = "xioctl(VIDIOC_QBUF) failed\n Last Error: No such device"
    assert wait_for(lambda: device.report().problems)
    assert "VIDIOC_QBUF) failed Last Error" in device.report().problems[0]
    library.failure = ""
    assert wait_for(lambda: not device.report().problems)


def test_closing_stops_the_camera(device, library):
    device.close()
    assert not library.running


@pytest.mark.parametrize(
    ("failure", "words"),
    [
        ("Couldn't resolve requests", "cannot deliver 64 x 48 at 30 Hz .choose another 'fps'"),
        ("xioctl failed: Device or resource busy", "another program uses the camera"),
        ("something\nelse", "something else"),
    ],
)
def test_a_camera_that_does_not_start_says_why_in_one_line(library, failure, words):
    library.failure = failure
    with pytest.raises(DeviceError, match=words) as caught:
        source(library).open()
    assert "\n" not in str(caught.value)


def test_no_camera_or_another_one_is_said_so(library):
    with pytest.raises(DeviceError, match=r"serial number 9 .111, 222 has"):
        source(library, serial="9").open()
    library.cameras = []
    with pytest.raises(DeviceError, match=r"no RealSense camera is connected .plug it into"):
        source(library).open()


def test_without_the_library_the_remedy_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyrealsense2", None)
    with pytest.raises(DeviceError, match=r"pip install 'zavis_bt\[robot\]'"):
        open_realsense({}, context())


def test_a_wrong_setting_is_refused_before_anything_is_opened():
    with pytest.raises(InputError, match=r"settings.serial_number: unknown setting .did you mean 'serial'"):
        open_realsense({"serial_number": "1"}, context())


def test_the_real_library_without_a_camera_says_so():
    pytest.importorskip("pyrealsense2")
    with pytest.raises(DeviceError, match="no RealSense camera"):
        open_realsense({"serial": "000000000000"}, context())
