"""Speeds of one axis, from one step to the next: ramps, and coming to rest at a mark."""

from __future__ import annotations

import math
from typing import NamedTuple

from sim.devices.arcos.limits import Axis


class Ramp(NamedTuple):
    """What an axis approaches in the next step."""

    speed: float
    change: float
    """Bound of the acceleration."""


def ramp(speed: float, wanted: float, axis: Axis) -> Ramp:
    """Return how to get from a speed to a wanted one: slow down to rest first where the direction changes."""
    if speed * wanted < 0:
        return Ramp(0.0, axis.deceleration)
    faster = abs(wanted) > abs(speed)
    return Ramp(wanted, axis.acceleration if faster else axis.deceleration)


def arrive(remaining: float, speed: float, axis: Axis, seconds: float) -> Ramp:
    """Return how to drive on to come to rest at a mark.

    Within a step the speed changes evenly from ``speed`` to v, so the way of it is (speed + v) / 2 · seconds; braking
    from v then takes v² / (2 · deceleration), but always a whole step. The v that uses up what remains solves a
    quadratic equation, or near the end a linear one.

    Args:
        remaining: Way to the mark, negative if it lies behind.
        speed: Present speed.
        axis: Bounds.
        seconds: Length of a step [s].
    """
    if remaining < 0:
        mirrored = arrive(-remaining, -speed, axis, seconds)
        return Ramp(-mirrored.speed, mirrored.change)
    if speed < 0:
        return Ramp(0.0, axis.deceleration)
    left = max(remaining - speed * seconds / 2, 0.0)
    half = axis.deceleration * seconds / 2
    braking = min(math.sqrt(half * half + 2 * axis.deceleration * left) - half, left / seconds)
    return ramp(speed, min(braking, axis.speed), axis)
