from __future__ import annotations

from typing import Any

import pytest
from scripted import Stage

from behaviours import Detect, Scan
from behaviours._percepts import Percepts
from zavis_bt.errors import DeviceError
from zavis_bt.mission import InlineJobs
from zavis_bt.tree import Status
from zavis_bt.types import Event, RgbdFrame

LOST = "my.robot.yaml: devices.camera: the connection is closed"


def lost() -> Any:
    raise DeviceError(LOST)


def lose(stage: Stage, every: int) -> None:
    """Let each so-and-so-many-th frame have no pixels, and perception look at pixels."""
    take, perceive, taken = stage.robot.camera.frame, stage.perceiver.perceive, []

    def frame() -> RgbdFrame:
        whole = take()
        taken.append(whole)
        if len(taken) % every:
            return whole
        return RgbdFrame(whole.intrinsics, whole.transform_camera_to_map, whole.stamp, lost)

    def look(seen: RgbdFrame, target: str) -> Any:
        assert seen.depth.any()
        return perceive(seen, target)

    stage.robot.camera.frame, stage.perceiver.perceive = frame, look


def events(stage: Stage) -> list[Event]:
    noted: list[Event] = []
    stage.journal.sinks.append(noted.append)
    return noted


def test_a_frame_whose_pixels_are_lost_is_dropped_and_the_scan_goes_on(stage):
    stage.perceiver.landmarks = {(2.0, 0.0): "desk", (0.0, -2.0): "bed"}
    lose(stage, every=4)
    noted = events(stage)
    assert stage.run(stage.setup(Scan(target="cup"))) is Status.SUCCESS
    reasons = [event.data["reason"] for event in noted if event.kind == "lost_frame"]
    assert reasons
    assert set(reasons) == {LOST}
    assert len(stage.perceiver.frames) >= 2 * len(reasons)
    assert {landmark.label for landmark in stage.mapper.semantic.landmarks} == {"desk", "bed"}


def test_what_only_lost_frames_showed_does_not_count_as_searched(stage):
    stage.perceiver.landmarks = {(2.0, 0.0): "desk"}
    assert stage.run(stage.setup(Detect(target="cup"))) is Status.FAILURE
    landmarks, grid, views = stage.mapper.semantic.landmarks, stage.mapper.grid, stage.mapper.views
    assert landmarks
    seen = views.chances(landmarks, grid).tolist()
    lose(stage, every=1)
    assert stage.run(stage.setup(Detect(target="cup"))) is Status.FAILURE
    assert stage.journal.counts["lost_frame"] == 1
    assert views.chances(landmarks, grid).tolist() == seen


def test_any_other_failure_of_perception_is_not_hidden(stage):
    def broken(frame: RgbdFrame, target: str) -> Any:
        raise ValueError("a bug")

    stage.perceiver.perceive = broken
    percepts = Percepts(stage.perceiver, stage.mapper, InlineJobs(stage.robot, latency={}), stage.journal, "cup")
    percepts.submit(stage.robot.camera.frame())
    with pytest.raises(ValueError, match="a bug"):
        percepts.poll()
    assert stage.journal.counts["lost_frame"] == 0
