"""Which of the sensor's steps are used, and where they look."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivers.lidar.codec import Parameters, ScanRequest
from drivers.lidar.codec.numbers import Numbers
from drivers.lidar.settings import ScipSettings
from zavis_bt.errors import DeviceError, InputError
from zavis_bt.types import LaserScan, LidarSpec

_SLACK = 1e-6  # of a step


@dataclass(frozen=True, slots=True)
class ScanLayout:
    """What to ask the sensor for, and how its readings become a scan."""

    request: ScanRequest
    angle_min: float
    """Of the first beam of the scan [rad]."""
    angle_increment: float
    """[rad]"""
    range_min: float
    """[m]"""
    range_max: float
    """[m]"""
    flipped: bool
    """Whether the sensor's order is the reverse of the scan's."""

    def scan(self, readings: Numbers, stamp: float) -> LaserScan:
        """Return the scan of (beams,) readings [mm]: beyond the range is +inf, below it, where the codes are, NaN."""
        ranges = (readings[::-1] if self.flipped else readings) / 1000.0
        beyond, below = ranges > self.range_max, ranges < self.range_min
        ranges[beyond] = np.inf
        ranges[below] = np.nan
        ranges.setflags(write=False)
        return LaserScan(ranges, self.angle_min, self.angle_increment, self.range_min, self.range_max, stamp)


def lay_out(sensor: Parameters, spec: LidarSpec, settings: ScipSettings, where: str) -> ScanLayout:
    """Return how to scan the spec's field of view with a sensor.

    Step i looks along 2π·(i − AFRT)/ARES (SCIP 2.0: PP). Of the steps within the field of view, whole clusters are
    taken; a beam looks along the middle of its cluster.

    Raises:
        DeviceError: The sensor does not look there at all.
        InputError: The cluster is larger than the field of view.
    """
    step = math.tau / sensor.ares
    reach = spec.field_of_view / 2 / step + _SLACK
    first = max(sensor.amin, math.ceil(sensor.afrt - reach))
    last = min(sensor.amax, math.floor(sensor.afrt + reach), first + sensor.ares - 1)
    if last < first:
        raise DeviceError(
            f"{where}: {sensor.model} measures nothing within {math.degrees(spec.field_of_view):.4g}° straight ahead "
            "(is 'lidar.field_of_view_deg' right?)"
        )
    beams = (last - first + 1) // settings.cluster
    if beams < 1:
        raise InputError(f"{where}.settings.cluster: {settings.cluster} is more than the {last - first + 1} steps seen")
    last = first + beams * settings.cluster - 1
    begin = (first + (settings.cluster - 1) / 2 - sensor.afrt) * step
    end = (last - (settings.cluster - 1) / 2 - sensor.afrt) * step
    return ScanLayout(
        ScanRequest("MD", first, last, settings.cluster, settings.skip),
        -end if settings.flipped else begin,
        settings.cluster * step,
        max(spec.range_min, sensor.dmin / 1000),
        min(spec.range_max, sensor.dmax / 1000),
        settings.flipped,
    )


def disagreements(sensor: Parameters, layout: ScanLayout, spec: LidarSpec) -> tuple[str, ...]:
    """Return where the sensor is not what the robot file says, one line each with the remedy."""
    found, beams = [], layout.request.beams
    covered = beams * layout.angle_increment
    if covered < spec.field_of_view - 2 * max(layout.angle_increment, spec.angle_increment):
        found.append(
            f"it sees {_degrees(covered)} of the {_degrees(spec.field_of_view)} in the robot file "
            f"(set lidar.field_of_view_deg)"
        )
    elif beams != spec.beams or abs(layout.angle_increment / spec.angle_increment - 1) > 0.01:
        found.append(
            f"it measures {beams} beams {_degrees(layout.angle_increment)} apart, in the robot file there are "
            f"{spec.beams} {_degrees(spec.angle_increment)} apart (set lidar.beams, or the setting 'cluster')"
        )
    if layout.range_max < spec.range_max - 1e-9:
        found.append(f"it measures up to {layout.range_max:g} m only (set lidar.range_max)")
    if layout.range_min > spec.range_min + 1e-9:
        found.append(f"it measures from {layout.range_min:g} m on only (set lidar.range_min)")
    rate = sensor.scan / 60 / (layout.request.skip + 1)
    if abs(rate / spec.rate - 1) > 0.05:
        found.append(
            f"it sends {rate:.3g} scans a second, in the robot file there are {spec.rate:g} "
            "(set lidar.rate, or the setting 'skip')"
        )
    return tuple(found)


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.4g}°"
