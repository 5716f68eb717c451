"""The borders of the framework: what a device, a model or a person must offer to take part in a mission.

Implementations need not inherit from these classes. None of the methods blocks unless it says so: devices keep
their latest state and hand it out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from zavis_bt.types import (
    Answer,
    BaseState,
    Box,
    Candidate,
    Detection,
    DeviceReport,
    FloatArray,
    LaserScan,
    MissionResult,
    Observed,
    PanTiltState,
    Pose2D,
    RgbdFrame,
    RobotSpec,
    Twist2D,
    Viewpoint,
)

T_co = TypeVar("T_co", covariant=True)
T = TypeVar("T")


class Clock(Protocol):
    """The mission's time."""

    def now(self) -> float:
        """Return the time since the clock's start [s]."""

    def wait_until(self, stamp: float) -> None:
        """Block until ``now() >= stamp``: a real clock sleeps, a lock-step simulation advances the world."""


class Base(Protocol):
    """A differential-drive base."""

    def state(self) -> BaseState:
        """Return the latest state. Its stamp stands still while the base is not heard of."""

    def pose_at(self, stamp: float) -> Pose2D:
        """Return the odometry pose at a time within the last second [s]; the nearest known one for other times."""

    def command(self, twist: Twist2D) -> None:
        """Drive with this velocity until the next command, speeding up and slowing down within the limits.

        The base stops by itself if no command follows in time.

        Raises:
            ValueError: The velocity is not finite.
            DeviceError: The base cannot be reached.
        """

    def stop(self) -> None:
        """Come to rest as fast as the base can, without regard to the limits.

        Never raises, may be called at any time and twice.
        """


class PanTilt(Protocol):
    """A pan-tilt unit."""

    def state(self) -> PanTiltState:
        """Return the latest joint angles. Their stamp stands still while the unit is not heard of."""

    def angles_at(self, stamp: float) -> tuple[float, float]:
        """Return pan and tilt [rad] at a time within the last second [s]; the nearest known ones for other times."""

    def move_to(self, pan: float, tilt: float) -> None:
        """Start a move to these angles [rad], clipped to the limits.

        Raises:
            ValueError: An angle is not a number.
            DeviceError: The unit cannot be reached.
        """

    def stop(self) -> None:
        """Come to rest now; never raises."""


class Lidar(Protocol):
    """A planar LiDAR."""

    def scan(self) -> LaserScan | None:
        """Return the latest scan, or None if there was none yet. The arrays are not changed afterwards."""


class Camera(Protocol):
    """An RGB-D camera."""

    def frame(self) -> RgbdFrame | None:
        """Return the latest frame, or None if there was none yet."""


class Robot(Protocol):
    """A robot: its devices and its model."""

    @property
    def spec(self) -> RobotSpec:
        """Footprint, limits, mounts."""

    @property
    def base(self) -> Base:
        """The mobile base."""

    @property
    def pan_tilt(self) -> PanTilt:
        """The pan-tilt unit."""

    @property
    def lidar(self) -> Lidar:
        """The LiDAR."""

    @property
    def camera(self) -> Camera:
        """The camera on the pan-tilt unit."""

    def close(self) -> None:
        """Stop all motion and release the devices; never raises, may be called twice."""


class Device(Protocol):
    """What every driver's device offers beside its use."""

    def report(self) -> DeviceReport:
        """Return its name plate, its figures so far and what is wrong with it."""

    def close(self) -> None:
        """Stop all motion and release the device; never raises, may be called twice."""


@dataclass(frozen=True, slots=True)
class DeviceContext:
    """What a driver is told when it opens a device."""

    where: str
    """Place in the robot file, to begin error messages with: ``my.robot.yaml: devices.base``."""
    spec: RobotSpec
    """The robot's model."""
    clock: Clock
    """The mission's clock, which all stamps are on."""
    start: Pose2D
    """Where the robot stands in the map when it is opened: the odometry begins there."""
    camera_pose: Callable[[float], FloatArray]
    """(4, 4) transform of optical camera points to the map at a time [s], by odometry and joint angles."""


DeviceFactory = Callable[[Mapping[str, Any], DeviceContext], Any]
"""Opens a device with the settings of the robot file. Entry points of the group ``zavis_bt.devices`` name such
functions, as ``base.<driver>``, ``pan_tilt.<driver>``, ``lidar.<driver>`` or ``camera.<driver>``.

It raises `InputError` for wrong settings and `DeviceError` if the device cannot be opened: one line with the remedy.
"""


class Detector(Protocol):
    """An open-set object detector."""

    def detect(self, frame: RgbdFrame) -> Sequence[Detection]:
        """Return boxes with a known class or ``unknown``, best first."""


class Matcher(Protocol):
    """A text-image matcher."""

    def match(self, frame: RgbdFrame, boxes: Sequence[Box], texts: Sequence[str]) -> FloatArray:
        """Return matching scores m, shape (n_boxes, n_texts), on the 100 × cosine scale (Eq. matching_score)."""


class KnowledgePrior(Protocol):
    """Commonsense: how likely is the target to be at a landmark."""

    def probability(self, target: str, landmarks: Sequence[str]) -> FloatArray:
        """Return p(target | landmark) in [0, 1], shape (n_landmarks,)."""


class VisitOrder(Protocol):
    """A strategy that decides in which order viewpoints are visited."""

    def __call__(
        self,
        start: Pose2D,
        viewpoints: Sequence[Viewpoint],
        prior: FloatArray,
        uncertainty: FloatArray,
        distances: Callable[[Pose2D], FloatArray],
        **settings: float,
    ) -> list[int]:
        """Return indices into ``viewpoints`` in visiting order, at most one viewpoint of each landmark.

        Args:
            start: Where the robot is.
            viewpoints: n candidates, several for each landmark.
            prior: (n,) p(target | landmark).
            uncertainty: (n,) semantic uncertainty of the landmark [nat].
            distances: Returns the (n,) distances from a pose to all viewpoints [m]; inf where there is no path.
            settings: The strategy's own parameters.
        """


class Job(Protocol[T_co]):
    """Work that was handed to an executor."""

    def done(self) -> bool:
        """Return whether ``result`` would return at once."""

    def result(self) -> T_co:
        """Return the outcome, or raise what the work raised; blocks until done."""

    def cancel(self) -> None:
        """Drop the work if it has not begun; its outcome is no longer wanted. May be called at any time."""


class Jobs(Protocol):
    """An executor for slow work. In lock step it works inline and charges a simulated latency."""

    def submit(self, label: str, work: Callable[..., T], *args: Any) -> Job[T]:
        """Start ``work(*args)``; ``label`` ("detect", "plan", …) names its kind for latencies and logs."""


class Human(Protocol):
    """The person who knows what is looked for."""

    def ask(self, target: str, candidates: Sequence[Candidate]) -> Job[Answer]:
        """Ask whether one of the candidates is the target; returns at once."""


class Journal(Protocol):
    """Where behaviours report what others count, show and record."""

    def record(self, kind: str, **data: Any) -> None:
        """Note an event: ``scan``, ``viewpoints``, ``visit``, ``path``, ``candidate``, ``ask``, ``found``, …."""


class Observer(Protocol):
    """Somebody who watches a mission: recorder, viewer, console. Must be quick; what it raises is only logged."""

    def on_start(self, mission: Observed) -> None:
        """Called once before the first tick."""

    def on_tick(self, mission: Observed) -> None:
        """Called after every tick."""

    def on_end(self, mission: Observed, result: MissionResult) -> None:
        """Called once, however the mission ended."""


Pixels = tuple[NDArray[np.uint8], NDArray[np.float32]]
Resources = Mapping[str, object]
