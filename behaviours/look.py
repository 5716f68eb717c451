"""Look: see a landmark from where the robot stands, in several pan-tilt directions."""

from __future__ import annotations

import math

from behaviours._sweep import CameraSweep, spread
from zavis_bt.geometry import aim
from zavis_bt.mapping import Mapper
from zavis_bt.protocols import Journal, Robot
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import RgbdFrame, Viewpoint


class Look(Behaviour):
    """Take frames that together cover a landmark, its top and its front, from the present pose.

    Counts as a visit to the landmark. Succeeds when the last frame is taken.
    """

    at = In(Viewpoint, "what to look at")
    low = In(float, "lowest height to cover", unit="m", default=0.1, ge=0.0)
    high = In(float, "greatest height to cover", unit="m", default=1.3, ge=0.0)
    overlap = In(float, "share that neighbouring frames have in common", default=0.3, ge=0.0, lt=0.9)
    frames = Out(list[RgbdFrame], "the frames taken")

    def setup(self, *, robot: Robot, mapper: Mapper, journal: Journal) -> None:
        """Take the resources."""
        self._robot, self._mapper, self._journal = robot, mapper, journal

    def initialise(self) -> None:
        """Choose the directions from the present pose."""
        self._frames: list[RgbdFrame] = []
        self._sweep = CameraSweep(self._robot, self._directions(self.at))

    def update(self) -> Status:
        """Take the frames."""
        frame = self._sweep.poll()
        if frame is not None:
            self._frames.append(frame)
        if not self._sweep.finished:
            return self.running(f"{self.at.label}, frame {self._sweep.progress}")
        self.frames = self._frames
        self._mapper.semantic.mark_visited(self.at.landmark)
        self._journal.record("visit", viewpoint=self.at)
        return self.succeed(f"{len(self._frames)} frames of {self.at.label}")

    def terminate(self, new_status: Status) -> None:
        """Stop the camera."""
        self._robot.pan_tilt.stop()

    def _directions(self, view: Viewpoint) -> list[tuple[float, float]]:
        spec, pose = self._robot.spec, self._robot.base.state().pose
        camera, limits, keep = spec.camera, spec.pan_tilt, 1 - self.overlap
        pan, _ = aim(pose, camera, view.look_at)
        distance = max(math.hypot(view.look_at[0] - pose.x, view.look_at[1] - pose.y), 0.3)
        half_width = math.atan2(view.radius, distance)
        top, bottom = (math.atan2(height - camera.height, distance) for height in (self.high, self.low))
        pans = spread(pan, half_width, camera.intrinsics.horizontal_fov * keep, limits.pan_min, limits.pan_max)
        tilts = spread(
            (top + bottom) / 2,
            (top - bottom) / 2,
            camera.intrinsics.vertical_fov * keep,
            limits.tilt_min,
            limits.tilt_max,
        )
        return [(p, t) for i, t in enumerate(tilts) for p in (pans if i % 2 == 0 else pans[::-1])]
