"""What a simulated LiDAR sees, turn by turn, in the numbers it sends."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivers.lidar.codec import Parameters, ScanRequest
from sim.devices.plant import Plant
from sim.physics import STEPS_PER_SECOND

NO_ECHO = 65533
"""Range of a beam without return."""
TOO_NEAR = 4
"""Range of a beam whose return is nearer than the sensor can measure; there are several such codes."""
_BRIGHTEST = 4000  # echo strength of what is right before the sensor
_SETTLING = 0.004  # that a step of the plant takes at most, unless the machine is loaded [s]
_STALE = 0.2  # [s] without a step of the plant, after which its time stands still

Numbers = NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """One turn's measurement."""

    time: float
    """When, by the clock [s]."""
    ranges: Numbers
    """(n,) of all steps [mm], or codes."""


class Eye:
    """Measures the plant's world; the same sweep for whoever asks within a turn."""

    def __init__(self, plant: Plant, parameters: Parameters, clock: Callable[[], float] = time.monotonic) -> None:
        """Look through the LiDAR of a robot.

        Args:
            plant: The robot.
            parameters: Of the sensor.
            clock: Real time [s].
        """
        self._plant, self._parameters, self._clock = plant, parameters, clock
        self._noted = -math.inf  # when the plant was last seen to step
        self._ahead: deque[float] = deque(maxlen=STEPS_PER_SECOND)  # of the clock before the plant's time, at each step
        self._last: tuple[int, Sweep] | None = None
        plant.controllers.append(self._note)

    def close(self) -> None:
        """Look no more at the plant's steps; may be called twice."""
        if self._note in self._plant.controllers:
            self._plant.controllers.remove(self._note)

    @property
    def fresh(self) -> float:
        """A moment at which the plant has just stepped, and so has all that are whole steps later [s].

        A LiDAR that measures then does not see where the robot was up to a step ago.
        """
        return self._due(0.0) + _SETTLING

    def sweep(self, turn: int) -> Sweep:
        """Return the measurement of this turn."""
        if self._last is None or self._last[0] != turn:
            self._last = turn, self._measure()
        return self._last[1]

    def _measure(self) -> Sweep:
        sensor = self._parameters
        step = math.tau / sensor.ares
        begin = None
        while begin != self._plant.now:  # the plant has not moved meanwhile
            begin = self._plant.now
            metres = self._plant.sweep(sensor.amax - sensor.amin + 1, (sensor.amin - sensor.afrt) * step, step)
        millimetres = np.rint(np.minimum(metres * 1000, NO_ECHO)).astype(np.int32)
        millimetres[millimetres > sensor.dmax] = NO_ECHO
        millimetres[millimetres < sensor.dmin] = TOO_NEAR
        return Sweep(min(self._due(begin), self._clock()), millimetres)

    def _due(self, plant_time: float) -> float:
        """Return when the plant is to be at ``plant_time`` [s]: steps come late on a loaded machine, never early."""
        now = self._clock()
        if now - self._noted > _STALE:
            return now
        return plant_time + min(tuple(self._ahead))

    def _note(self, now: float) -> None:
        """Note that the plant is at ``now`` [s], and is about to be one step further, which is due this moment."""
        if now == 0.0:  # the first step is done before time begins to pass
            return
        self._noted = self._clock()
        self._ahead.append(self._noted - (now + 1 / STEPS_PER_SECOND))


def chosen(sweep: Sweep, request: ScanRequest, first_step: int) -> Numbers:
    """Return what a request gets of a sweep: ranges, or ranges and echo strengths in turn.

    Args:
        sweep: Of all steps.
        request: Steps beyond what is measured get the code of no echo.
        first_step: Of the sweep.
    """
    steps = np.full(request.end - request.start + 1, NO_ECHO, dtype=np.int32)
    begin = max(request.start, first_step)
    seen = sweep.ranges[begin - first_step : max(request.end - first_step + 1, 0)]
    steps[begin - request.start :][: len(seen)] = seen
    cluster = max(request.cluster, 1)
    if cluster > 1:
        steps = np.minimum.reduceat(steps, np.arange(0, len(steps), cluster))
    ranges = np.minimum(steps, (1 << 6 * request.digits) - 1)
    if not request.paired:
        return ranges
    return np.column_stack((ranges, _strengths(steps))).astype(np.int32).ravel()


def _strengths(ranges: Numbers) -> Numbers:
    """Return echo strengths, which fall with the distance; 0 without echo."""
    strengths = _BRIGHTEST / (1 + ranges / 1000)
    strengths[ranges == NO_ECHO] = 0
    return np.rint(strengths).astype(np.int32)
