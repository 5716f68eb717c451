from __future__ import annotations

import threading
from collections import deque
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from camera_rigs import context, wait_for

from drivers.camera import AnnotatedFrame, CameraDevice
from drivers.camera.source import Capture, NamePlate
from zavis_bt.errors import DeviceError
from zavis_bt.types import CameraIntrinsics

INTRINSICS = CameraIntrinsics(4, 3, 5.0, 5.0, 2.0, 1.5)


def images():
    return np.zeros((3, 4, 3), np.uint8), np.ones((3, 4), np.float32)


class Script:
    """A source that does what it is told."""

    def __init__(self) -> None:
        self.captures: deque[Capture | DeviceError] = deque()
        self.refusals = 0
        self.opened = self.closed = 0

    def open(self) -> NamePlate:
        if self.refusals:
            self.refusals -= 1
            raise DeviceError("camera: still away")
        self.opened += 1
        return NamePlate("scripted", "1.0", "42", {"lens": "good"})

    def capture(self, timeout: float) -> Capture | None:
        if not self.captures:
            threading.Event().wait(0.01)
            return None
        step = self.captures.popleft()
        if isinstance(step, DeviceError):
            raise step
        return step

    def close(self) -> None:
        self.closed += 1


@pytest.fixture
def script():
    return Script()


@pytest.fixture
def device(script):
    camera = CameraDevice(script, context())
    yield camera
    camera.close()


def test_a_camera_that_cannot_be_opened_is_no_device():
    script = Script()
    script.refusals = 1
    with pytest.raises(DeviceError, match="still away"):
        CameraDevice(script, context())


def test_the_latest_frame_stays_until_the_next(script, device):
    assert device.frame() is None
    script.captures += [Capture(1.0, INTRINSICS, images), Capture(2.0, INTRINSICS, images)]
    assert wait_for(lambda: (frame := device.frame()) is not None and frame.stamp == 2.0)
    assert device.frame() is device.frame()


def test_the_pose_is_that_of_the_time_of_capture(script, device):
    script.captures.append(Capture(1.25, INTRINSICS, images))
    assert wait_for(device.frame)
    assert device.frame().transform_camera_to_map[0, 3] == 1.25


def test_pixels_are_decoded_when_asked_for_once_and_cannot_be_changed(script, device):
    calls = []
    script.captures.append(Capture(1.0, INTRINSICS, lambda: calls.append(1) or images()))
    assert wait_for(device.frame)
    assert not calls
    frame = device.frame()
    assert frame.rgb is frame.rgb
    assert frame.depth.shape == (3, 4)
    assert calls == [1]
    with pytest.raises(ValueError, match="read-only"):
        frame.depth[0, 0] = 1.0


def test_pixels_that_could_not_be_had_may_be_asked_for_again(script, device):
    outcomes = [DeviceError("camera: lost"), images()]

    def fetch():
        outcome = outcomes.pop(0)
        if isinstance(outcome, DeviceError):
            raise outcome
        return outcome

    script.captures.append(Capture(1.0, INTRINSICS, fetch))
    assert wait_for(device.frame)
    frame = device.frame()
    with pytest.raises(DeviceError, match="lost"):
        frame.depth.max()
    assert frame.depth.max() == 1.0
    assert frame.rgb.max() == 0


def test_whoever_looks_at_a_frame_gets_the_same_pixels_and_keeps_no_other_frame_waiting(script, device):
    calls, begun, go_on = [], threading.Event(), threading.Event()

    def slow():
        calls.append(1)
        begun.set()
        assert go_on.wait(20)
        return images()

    script.captures.append(Capture(1.0, INTRINSICS, slow))
    assert wait_for(device.frame)
    first = device.frame()
    with ThreadPoolExecutor(3) as pool:
        looks = [pool.submit(lambda: first.rgb) for _ in range(3)]
        assert begun.wait(20)
        script.captures.append(Capture(2.0, INTRINSICS, images))
        assert wait_for(lambda: device.frame() is not first)
        assert device.frame().depth.max() == 1.0
        assert not any(look.done() for look in looks)
        go_on.set()
        seen = [look.result(20) for look in looks]
    assert calls == [1]
    assert seen[0] is seen[1] is seen[2]


def test_a_frame_is_annotated_if_its_capture_is(script, device):
    script.captures.append(Capture(1.0, INTRINSICS, images, ()))
    assert wait_for(device.frame)
    assert isinstance(device.frame(), AnnotatedFrame)
    assert device.frame().annotations == ()


def test_a_frame_that_is_not_later_is_passed_over(script, device):
    script.captures += [Capture(1.0, INTRINSICS, images), Capture(1.0, INTRINSICS, images)]
    assert wait_for(device.frame)
    first = device.frame()
    assert wait_for(lambda: not script.captures)
    assert device.frame() is first


def test_after_a_loss_it_reconnects_and_keeps_the_old_frame_meanwhile(script, device):
    script.captures.append(Capture(1.0, INTRINSICS, images))
    assert wait_for(device.frame)
    old = device.frame()
    script.refusals = 2
    script.captures.append(DeviceError("camera: unplugged"))
    assert wait_for(lambda: device.report().problems)
    assert device.frame() is old
    assert wait_for(lambda: script.opened == 2 and not device.report().problems)
    script.captures.append(Capture(2.0, INTRINSICS, images))
    assert wait_for(lambda: device.frame().stamp == 2.0)
    assert device.report().figures["lost"] == "1 times"


def test_the_report_has_plate_figures_and_rate(script, device):
    script.captures += [Capture(0.1 * n, INTRINSICS, images) for n in range(1, 4)]
    assert wait_for(lambda: (frame := device.frame()) is not None and frame.stamp > 0.25)
    report = device.report()
    assert (report.model, report.firmware, report.serial) == ("scripted", "1.0", "42")
    assert report.figures["lens"] == "good"
    assert {"age of the latest frame", "latency", "rate"} <= set(report.figures)
    assert report.problems == ()


def test_silence_is_a_problem(script):
    late = context()
    device = CameraDevice(script, late)
    late.clock._zero -= 60.0  # a minute passes
    assert "no frame for 6" in device.report().problems[0]
    device.close()


def test_closing_releases_the_source_and_may_be_done_twice(script, device):
    device.close()
    device.close()
    assert script.closed == 1
