"""Scan: look all around for landmarks and for the target."""

from __future__ import annotations

import math

from behaviours._percepts import Percepts
from behaviours._sweep import CameraSweep, sweep_directions
from behaviours._turn import Turn
from zavis_bt.mapping import Mapper
from zavis_bt.perception import Perceiver
from zavis_bt.planning import Navigator
from zavis_bt.protocols import Jobs, Journal, Robot
from zavis_bt.tree import Behaviour, In, Out, Status
from zavis_bt.types import Candidate, Pose2D, Twist2D


class Scan(Behaviour):
    """Sweep the pan-tilt camera over the LiDAR's range, turn the base, sweep again, until all around was seen.

    Landmarks and the target are detected on the same frames (paper, section "Zero-shot Active Visual Search").
    Succeeds when the last frame was looked at, with or without candidates. Where there is no room to turn, it
    covers what it can.
    """

    target = In(str, "what to look for on the way")
    turns = In(float, "share of a full turn to cover", default=1.0, gt=0.0, le=1.0)
    tilts = In(list[float], "tilt of each pass of the camera, up positive", unit="rad", default=[-0.35, 0.0])
    overlap = In(float, "share that neighbouring frames have in common", default=0.5, ge=0.0, lt=0.9)
    candidates = Out(list[Candidate], "what may be the target, best first")
    landmarks = Out(int, "landmarks on the semantic map after the scan")

    def setup(
        self, *, robot: Robot, mapper: Mapper, navigator: Navigator, perceiver: Perceiver, jobs: Jobs, journal: Journal
    ) -> None:
        """Take the resources."""
        self._robot, self._mapper, self._navigator, self._journal = robot, mapper, navigator, journal
        self._perceiver, self._jobs = perceiver, jobs

    def initialise(self) -> None:
        """Plan the sweeps from the present heading on."""
        spec = self._robot.spec
        reach = spec.pan_tilt.pan_max - spec.pan_tilt.pan_min + spec.camera.intrinsics.horizontal_fov
        total = math.tau * self.turns
        sector = min(spec.lidar.field_of_view, reach, total)
        stops = math.ceil(total / sector - 1e-9)
        start = self._robot.base.state().pose.yaw
        self._headings = [start + i * total / stops for i in range(stops)]
        self._directions = sweep_directions(spec, total / stops, self.overlap, self.tilts)
        self._percepts = Percepts(self._perceiver, self._mapper, self._jobs, self._journal, self.target)
        self._sweep = CameraSweep(self._robot, self._directions)
        self._turn: Turn | None = None
        self._stop = 0

    def update(self) -> Status:
        """Take frames, turn, and wait for the last one to be looked at."""
        done = self._percepts.poll()
        if self._turn is not None:
            return self._turning()
        frame = self._sweep.poll()
        if frame is not None:
            self._percepts.submit(frame)
        if not self._sweep.finished:
            return self.running(f"frame {self._sweep.progress}, heading {self._stop + 1}/{len(self._headings)}")
        if self._stop + 1 < len(self._headings) and self._room_to_turn():
            self._stop += 1
            self._turn = Turn(self._robot, self._headings[self._stop])
            return self._turning()
        if not done or not self._percepts.poll():
            return self.running("looking at the last frames")
        return self._finish()

    def terminate(self, new_status: Status) -> None:
        """Stop what moves."""
        self._percepts.cancel()
        self._robot.pan_tilt.stop()
        self._robot.base.command(Twist2D())

    def _turning(self) -> Status:
        assert self._turn is not None
        if self._turn.update():
            self._turn, self._sweep = None, CameraSweep(self._robot, self._directions)
        return self.running("turning")

    def _room_to_turn(self) -> bool:
        pose: Pose2D = self._robot.base.state().pose
        return self._navigator.can_turn(pose)

    def _finish(self) -> Status:
        self.candidates = self._percepts.best_first()
        self.landmarks = len(self._mapper.semantic.landmarks)
        self._journal.record("scan", landmarks=self.landmarks, candidates=len(self.candidates))
        return self.succeed(f"{self.landmarks} landmarks, {len(self.candidates)} candidates")
