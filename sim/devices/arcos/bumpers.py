"""Bumper segments and stalled wheels, from how the base meets obstacles."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from sim.devices.arcos.model import PioneerModel
from sim.devices.plant import Plant
from sim.kinematics import Motion
from zavis_bt.types import FloatArray, Footprint, Pose2D

_SPAN = math.radians(135)  # that the segments of a bumper share
_SOFT = 0.03  # segments this much farther from the obstacle than the nearest are pressed too [m]


class Bumpers:
    """Front and rear bumper, bit 0 the first segment: at the left of the front, at the right of the rear."""

    def __init__(self, plant: Plant, model: PioneerModel) -> None:
        """Feel nothing."""
        self.front = self.rear = 0
        """Pressed segments."""
        self.stalled = False
        """Whether the wheels are held fast, or were a moment ago."""
        self._plant, self._hold = plant, model.config.stall_count / 1000
        self._front = _directions(model.config.front_bumpers, 0.0)
        self._rear = _directions(model.config.rear_bumpers, math.pi)
        self._speed, self._stalled_until = 0.0, -math.inf
        self._met = 0, 0.0

    def step(self, now: float, motion: Motion, commanded: float) -> bool:
        """Feel; return whether a bumper has just met something.

        Args:
            now: [s]
            motion: Present contact and velocities.
            commanded: Translation that the motors try [m/s].
        """
        direction = np.sign(self._speed or commanded)
        self._speed = motion.linear
        contact = motion.contact
        if contact.stalled:
            self._stalled_until = now + self._hold
        self.stalled = now < self._stalled_until
        if not contact.touching:
            self.front = self.rear = 0
            self._met = contact.number, 0.0
        elif contact.stalled and self._met != (contact.number, direction):
            self._met = contact.number, float(direction)
            self.front, self.rear = self._pressed(direction)
            return True
        return False

    def _pressed(self, direction: float) -> tuple[int, int]:
        """Return the segments near an obstacle, at the end that moves into it; at both for a turn on the spot."""
        front = self._clearances(self._front) if direction >= 0 else np.empty(0)
        rear = self._clearances(self._rear) if direction <= 0 else np.empty(0)
        limit = min((*front, *rear), default=0.0) + _SOFT
        return _bits(front <= limit), _bits(rear <= limit)

    def _clearances(self, directions: FloatArray) -> FloatArray:
        footprint = self._plant.spec.footprint
        edges = np.array([_edge(footprint, direction) for direction in directions])
        reach = footprint.circumscribed_radius + 1.0
        clearances: FloatArray = self._plant.probe(Pose2D(0.0, 0.0), directions, reach) - edges
        return clearances


def _directions(segments: int, middle: float) -> FloatArray:
    width = _SPAN / max(segments, 1)
    return np.array([middle + _SPAN / 2 - width * (segment + 0.5) for segment in range(segments)])


def _edge(footprint: Footprint, direction: float) -> float:
    """Return the distance of the outline from the base's origin in a direction [m]."""
    if footprint.disc:
        return footprint.length / 2
    cos, sin = math.cos(direction), abs(math.sin(direction))
    along = footprint.length / 2 + math.copysign(footprint.centre_x, cos)
    return min(along / max(abs(cos), 1e-9), footprint.width / 2 / max(sin, 1e-9))


def _bits(pressed: Iterable[bool]) -> int:
    return sum(1 << segment for segment, is_pressed in enumerate(pressed) if is_pressed)
