"""Opening a device, watching it for a while and saying what is wrong with it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from zavis_bt.errors import DeviceError, ZavisError
from zavis_bt.mission.device_robot import open_device
from zavis_bt.mission.robot_file import RobotFile
from zavis_bt.protocols import Base, Camera, Clock, Device, Lidar, PanTilt
from zavis_bt.types import LaserScan, RgbdFrame, RobotSpec

_POLL = 0.004  # between two looks at a device [s]
_SLOW = 0.8  # share of the rate in the robot file below which a sensor is too slow
_ENOUGH = 5  # measurements to judge a rate by
_USUAL_RATE = 10.0  # of devices for which the robot file has none [Hz]
_LOW_BATTERY = 0.2
_PATIENCE = 3.0  # so long a device may take to say its first word, beyond the time it is watched [s]


@dataclass(frozen=True, slots=True)
class Finding:
    """What came of looking at a device."""

    kind: str
    driver: str
    model: str = ""
    firmware: str = ""
    serial: str = ""
    figures: Mapping[str, str] = field(default_factory=dict)
    problems: tuple[str, ...] = ()
    opened: bool = True

    @property
    def ok(self) -> bool:
        """Whether all is well."""
        return not self.problems


@dataclass
class Watch:
    """When a device was heard of, and how old its word was by then."""

    stamps: list[float] = field(default_factory=list)
    ages: list[float] = field(default_factory=list)

    def note(self, stamp: float | None, now: float) -> None:
        """Take what a device delivers at ``now``, measured at ``stamp`` [s]."""
        if stamp is not None and (not self.stamps or stamp > self.stamps[-1]):
            self.stamps.append(stamp)
            self.ages.append(now - stamp)

    @property
    def rate(self) -> float:
        """Measurements a second [Hz]."""
        span = self.stamps[-1] - self.stamps[0] if len(self.stamps) > 1 else 0.0
        return (len(self.stamps) - 1) / span if span > 0 else 0.0

    @property
    def longest_gap(self) -> float:
        """Longest time between two measurements [s]."""
        return max((after - before for before, after in zip(self.stamps, self.stamps[1:], strict=False)), default=0.0)

    def figures(self) -> dict[str, str]:
        """Return rate, age and gaps in words."""
        if len(self.stamps) < 2:
            return {}
        return {
            "rate": f"{self.rate:.1f} Hz",
            "age when it arrives": f"{np.median(self.ages) * 1000:.0f} ms, at most {max(self.ages) * 1000:.0f} ms",
            "longest gap": f"{self.longest_gap * 1000:.0f} ms",
        }


def examine(
    file: RobotFile, kind: str, clock: Clock, seconds: float, progress: Callable[[float], None] = lambda share: None
) -> Finding:
    """Open a device, watch it, and close it again; it does not move.

    Args:
        file: The robot.
        kind: ``base``, ``pan_tilt``, ``lidar`` or ``camera``.
        clock: That stamps are on.
        seconds: How long to watch.
        progress: Told the share of that time that has passed.
    """
    driver = file.devices[kind].driver if kind in file.devices else ""
    begin = time.monotonic()
    try:
        device = open_device(file, kind, clock)
    except ZavisError as error:
        return Finding(kind, driver, problems=(_without_place(str(error), file, kind),), opened=False)
    try:
        opened = f"{time.monotonic() - begin:.2f} s"
        watch = _watch(_READERS[kind](device), clock, seconds, progress)
        report = device.report()
        # its driver knows best; what can be seen from outside is said if the driver has nothing to say
        problems = report.problems or tuple(_problems(kind, device, watch, file.spec, seconds))
    finally:
        device.close()
    figures = {"opened in": opened, **watch.figures(), **report.figures}
    told = tuple(_without_place(problem, file, kind) for problem in problems)
    return Finding(kind, driver, report.model, report.firmware, report.serial, figures, told)


def _without_place(message: str, file: RobotFile, kind: str) -> str:
    """Leave out the place in the robot file, where the device's name stands beside the message anyway."""
    return message.removeprefix(f"{file.path}: devices.{kind}: ")


# -- watching --------------------------------------------------------------------------------------------------------


def _watch(stamp: Callable[[], float | None], clock: Clock, seconds: float, progress: Callable[[float], None]) -> Watch:
    watch, last_chance = Watch(), clock.now() + _PATIENCE
    while stamp() is None and clock.now() < last_chance:
        clock.wait_until(clock.now() + _POLL)
    begin = clock.now()
    while (passed := clock.now() - begin) < seconds:
        watch.note(stamp(), clock.now())
        progress(passed / seconds)
        clock.wait_until(clock.now() + _POLL)
    progress(1.0)
    return watch


def _stamp_of_scan(device: Any) -> float | None:
    scan = cast(Lidar, device).scan()
    return None if scan is None else scan.stamp


def _stamp_of_frame(device: Any) -> float | None:
    frame = cast(Camera, device).frame()
    return None if frame is None else frame.stamp


_READERS: Mapping[str, Callable[[Device], Callable[[], float | None]]] = {
    "base": lambda device: lambda: cast(Base, device).state().stamp,
    "pan_tilt": lambda device: lambda: cast(PanTilt, device).state().stamp,
    "lidar": lambda device: lambda: _stamp_of_scan(device),
    "camera": lambda device: lambda: _stamp_of_frame(device),
}


# -- judging ---------------------------------------------------------------------------------------------------------


def _problems(kind: str, device: Any, watch: Watch, spec: RobotSpec, seconds: float) -> Iterator[str]:
    promised = {"lidar": spec.lidar.rate, "camera": spec.camera.rate}.get(kind)
    if len(watch.stamps) < 2 and seconds * (promised or _USUAL_RATE) >= _ENOUGH:
        yield f"said nothing{' new' * bool(watch.stamps)} for {seconds:g} s"
    if promised and len(watch.stamps) >= _ENOUGH and watch.rate < _SLOW * promised:
        yield (
            f"{watch.rate:.1f} Hz instead of the {promised:g} Hz of the robot file "
            f"(is the line or this computer too slow? otherwise correct {kind}.rate)"
        )
    match kind:
        case "base":
            yield from base_problems(device)
        case "pan_tilt":
            yield from pan_tilt_problems(device, spec)
        case "lidar":
            yield from scan_problems(cast(Lidar, device).scan(), spec)
        case "camera":
            yield from frame_problems(cast(Camera, device).frame(), spec)


def base_problems(base: Base) -> Iterator[str]:
    """Yield what is wrong with a base that is open."""
    state = base.state()
    if state.fault:
        yield state.fault
    if state.estop:
        yield "the emergency stop is pressed (release it)"
    if state.bumper:
        yield "a bumper is pressed (free the robot)"
    if state.stalled:
        yield "a wheel is held fast (free the robot)"
    if state.battery < _LOW_BATTERY:
        yield f"battery at {state.battery:.0%} (charge it)"


def pan_tilt_problems(unit: PanTilt, spec: RobotSpec) -> Iterator[str]:
    """Yield what is wrong with a pan-tilt unit that is open."""
    state, limits = unit.state(), spec.pan_tilt
    if state.fault:
        yield state.fault
    slack = math.radians(1.0)
    for name, angle, low, high in (
        ("pan", state.pan, limits.pan_min, limits.pan_max),
        ("tilt", state.tilt, limits.tilt_min, limits.tilt_max),
    ):
        if not low - slack <= angle <= high + slack:
            yield (
                f"{name} is at {math.degrees(angle):.0f}°, outside of its limits of the robot file "
                f"({math.degrees(low):.0f}° to {math.degrees(high):.0f}°; does it need homing?)"
            )


def scan_problems(scan: LaserScan | None, spec: RobotSpec) -> Iterator[str]:
    """Yield what is wrong with a LiDAR's latest scan."""
    if scan is None:
        yield "no scan arrived"
        return
    width, expected = scan.angle_increment * (len(scan.ranges) - 1), spec.lidar.angle_increment * (spec.lidar.beams - 1)
    if width < expected - math.radians(2.0):
        yield (
            f"the scan spans {math.degrees(width):.0f}°, the robot file says {math.degrees(expected):.0f}° "
            "(correct lidar.field_of_view_deg, or the sensor's own settings)"
        )
    seen = np.isfinite(scan.ranges) & (scan.ranges >= scan.range_min)
    if not seen.any():
        yield "no beam returns anything (is the window covered, or nothing within its range?)"
    elif np.isnan(scan.ranges).mean() > 0.2:
        yield f"{np.isnan(scan.ranges).mean():.0%} of the beams are broken (is the window dirty?)"


def frame_problems(frame: RgbdFrame | None, spec: RobotSpec) -> Iterator[str]:
    """Yield what is wrong with a camera's latest frame."""
    if frame is None:
        yield "no frame arrived"
        return
    try:
        rgb, depth, wanted = frame.rgb, frame.depth, spec.camera.intrinsics
    except DeviceError as error:  # its pixels are fetched only now
        yield str(error)
        return
    height, width = rgb.shape[:2]
    if (width, height) != (wanted.width, wanted.height):
        said = f"{wanted.width} x {wanted.height}"
        yield f"frames are {width} x {height}, the robot file says {said} (correct camera.image)"
    if int(rgb.max()) < 10:
        yield "the picture is black (is the lens covered, or the room dark?)"
    if not (depth > 0).any():
        yield "the picture has no depth at all (is everything too near or too far, or the projector off?)"
