"""The sonar rings: which transducer fires when, and what comes back."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sim.devices.arcos.model import PioneerModel
from sim.devices.plant import Plant
from zavis_bt.types import Pose2D

_BEAM = np.radians(np.linspace(-12.0, 12.0, 5))  # rays that stand for the cone of sound [rad]
_RING = 8  # transducers of an array
_EARLY = 1e-6  # rounding of times [s]
_CYCLES = range(20, 1000)  # what SONARCYCLE may say [ms]


class Sonar:
    """Arrays of eight transducers. In each cycle every array that is on fires one of them."""

    def __init__(self, plant: Plant, model: PioneerModel) -> None:
        """Switch all arrays on."""
        self._plant, self._limit = plant, model.sonar_range
        self._mounts = [Pose2D(*pose) for pose in model.transducers.tolist()]
        numbers = range(len(self._mounts))
        self._orders: list[Sequence[int]] = [numbers[first : first + _RING] for first in numbers[::_RING]]
        self._on = [True] * len(self._orders)
        self._cycle = model.config.sonar_cycle / 1000
        self._due, self._turn = 0.0, 0
        self._heard: dict[int, int] = {}

    @property
    def flags(self) -> int:
        """Bit 1 for the first array, bit 2 for the second …: which are on."""
        return sum(1 << (array + 1) for array, on in enumerate(self._on) if on)

    @property
    def cycle_ms(self) -> int:
        """Time between two firings of an array [ms]."""
        return round(self._cycle * 1000)

    def switch(self, argument: int) -> None:
        """Switch arrays (SONAR): bit 0 on or off, bits 1 to 3 the number of the array, 0 for all."""
        number = argument >> 1 & 7
        for array in range(len(self._on)):
            if number in (0, array + 1):
                self._on[array] = bool(argument & 1)

    def set_cycle(self, milliseconds: int) -> None:
        """Set the time between two firings of an array (SONARCYCLE) [ms]."""
        if milliseconds in _CYCLES:
            self._cycle = milliseconds / 1000

    def poll(self, sequence: bytes) -> None:
        """Set the order of firing (POLLING): transducers by number from 1; an array without any stays as it was."""
        for array in range(len(self._orders)):
            ring = range(array * _RING, min((array + 1) * _RING, len(self._mounts)))
            if order := [number - 1 for number in sequence if number - 1 in ring]:
                self._orders[array] = order

    def step(self, now: float) -> None:
        """Fire what is due at a time [s]."""
        if now < self._due - _EARLY:
            return
        self._due = max(self._due + self._cycle, now)
        for order, on in zip(self._orders, self._on, strict=True):
            if on:
                number = order[self._turn % len(order)]
                self._heard[number] = self._listen(self._mounts[number])
        self._turn += 1

    def take(self) -> tuple[tuple[int, int], ...]:
        """Return transducer and range [mm] of all that fired since this was last called."""
        heard, self._heard = self._heard, {}
        return tuple(heard.items())

    def _listen(self, mount: Pose2D) -> int:
        nearest = float(self._plant.probe(mount, _BEAM, self._limit / 1000).min())
        return self._limit if math.isinf(nearest) else round(nearest * 1000)
