"""Motion of a differential-drive base among obstacles.

Velocities follow their targets within the acceleration limits; the pose follows exact arcs of constant twist. A move
that would overlap an obstacle ends at the contact: the base stalls, never passes through, and can leave again.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.collision import Body, is_free
from zavis_bt.types import FloatArray

_BISECTIONS = 20  # finds the contact to a millionth of a step
_RELEASE = 0.002  # [m], [rad] a contact ends when the base has moved this far from it


class Ground(NamedTuple):
    """What the base drives on."""

    occupied: NDArray[np.bool_]
    """(rows, cols)"""
    resolution: float
    x0: float
    """Outer corner of cell [0, 0] [m]."""
    y0: float


class Place(NamedTuple):
    """A pose in the map [m, rad]."""

    x: float
    y: float
    yaw: float


class Contact(NamedTuple):
    """How the base meets obstacles."""

    stalled: bool
    """The last step was cut short."""
    touching: bool
    """Still at the obstacle that was met last."""
    place: Place
    """Where it was met."""
    number: int
    """Contacts so far."""


class Motion(NamedTuple):
    """State of the moving base."""

    true: Place
    odometry: Place
    linear: float
    """[m/s]"""
    angular: float
    """[rad/s]"""
    travelled: float
    """Length of the true path [m]."""
    contact: Contact


class Drive(NamedTuple):
    """What the base is told, and how fast it may follow."""

    linear: float
    """Wanted [m/s]."""
    angular: float
    """Wanted [rad/s]."""
    expires: int
    """From this step on the wanted velocity is zero: the watchdog."""
    linear_change: float
    """Largest change in a step [m/s]."""
    angular_change: float
    """Largest change in a step [rad/s]."""


class OdometryError(NamedTuple):
    """Random walk of the odometry: variance gathered on the way, independent of how finely it is sampled."""

    any: bool = False
    """Whether there is any; without it odometry is the true pose."""
    rotation_per_radian: float = 0.0
    """[rad²/rad]"""
    rotation_per_metre: float = 0.0
    """[rad²/m]"""
    distance_per_metre: float = 0.0
    """[m²/m]"""
    distance_per_radian: float = 0.0
    """[m²/rad]"""


def at_rest(x: float, y: float, yaw: float) -> Motion:
    """Return the state of a base that stands there and never met anything."""
    place = Place(float(x), float(y), float(yaw))
    return Motion(place, place, 0.0, 0.0, 0.0, Contact(False, False, place, 0))


@njit(cache=True, nogil=True)
def advance(
    motion: Motion,
    command: Drive,
    ground: Ground,
    body: Body,
    first: int,
    seconds: float,
    history: FloatArray,
    error: OdometryError,
    normals: FloatArray,
) -> Motion:
    """Move the base over some steps.

    Args:
        motion: State before.
        command: What to do.
        ground: Where.
        body: Outline in cells.
        first: Number of the first step.
        seconds: Length of a step [s].
        history: (n, 6) ring, written: true and odometry pose after step i in row (i + 1) modulo n.
        error: Of the odometry.
        normals: (steps, 2) standard normal deviates of distance and rotation, a row per step.

    Returns:
        State after the last step.
    """
    for index in range(normals.shape[0]):
        motion = _step(motion, command, first + index < command.expires, ground, body, seconds, error, normals[index])
        row = (first + index + 1) % history.shape[0]
        history[row, 0], history[row, 1], history[row, 2] = motion.true
        history[row, 3], history[row, 4], history[row, 5] = motion.odometry
    return motion


@njit(cache=True, nogil=True)
def _step(
    motion: Motion,
    command: Drive,
    alive: bool,
    ground: Ground,
    body: Body,
    seconds: float,
    error: OdometryError,
    normals: FloatArray,
) -> Motion:
    linear = _towards(motion.linear, command.linear if alive else 0.0, command.linear_change)
    angular = _towards(motion.angular, command.angular if alive else 0.0, command.angular_change)
    v, w = (motion.linear + linear) / 2, (motion.angular + angular) / 2
    share = _free_share(ground, body, motion.true, v, w, seconds)
    driven, turned = v * share * seconds, w * share * seconds
    place = _arc(motion.true, driven, turned)
    if share < 1.0:
        # The base is held, but a turn on the spot may still be possible: a disc can always turn away.
        rest = (1.0 - share) * seconds if v != 0.0 else 0.0
        spin = rest * _free_share(ground, body, place, 0.0, w, rest)
        place = _arc(place, 0.0, w * spin)
        turned += w * spin
        linear, angular = 0.0, angular if 0.0 < rest == spin else 0.0
    contact = _meet(motion.contact, place, share < 1.0, body.disc)
    odometry = _dead_reckon(motion.odometry, driven, turned, error, normals) if error.any else place
    return Motion(place, odometry, linear, angular, motion.travelled + abs(driven), contact)


@njit(cache=True, nogil=True)
def _towards(value: float, target: float, largest: float) -> float:
    return value + min(max(target - value, -largest), largest)


@njit(cache=True, nogil=True)
def _arc(place: Place, driven: float, turned: float) -> Place:
    """Return the end of an arc: the chord of length driven · sinc(turned / 2), half turned."""
    half = turned / 2
    chord = driven * (math.sin(half) / half if abs(half) > 1e-6 else 1.0 - half * half / 6)
    yaw = place.yaw + turned
    return Place(
        place.x + chord * math.cos(place.yaw + half),
        place.y + chord * math.sin(place.yaw + half),
        yaw - math.tau * math.floor(yaw / math.tau + 0.5) if abs(yaw) > math.pi else yaw,
    )


@njit(cache=True, nogil=True)
def _free_share(ground: Ground, body: Body, place: Place, v: float, w: float, seconds: float) -> float:
    """Return the largest known share of a step, 0 to 1, that ends free of obstacles."""
    if (v == 0.0 and w == 0.0) or _free_at(ground, body, _arc(place, v * seconds, w * seconds)):
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        if _free_at(ground, body, _arc(place, v * middle * seconds, w * middle * seconds)):
            low = middle
        else:
            high = middle
    return low


@njit(cache=True, nogil=True)
def _free_at(ground: Ground, body: Body, place: Place) -> bool:
    u = (place.x - ground.x0) / ground.resolution - 0.5
    v = (place.y - ground.y0) / ground.resolution - 0.5
    return is_free(ground.occupied, body, u, v, place.yaw)


@njit(cache=True, nogil=True)
def _meet(contact: Contact, place: Place, stalled: bool, disc: bool) -> Contact:
    """Return the contact after a step: a new one is counted once, and ends when the base has moved away."""
    if stalled:
        return Contact(True, True, place, contact.number + (0 if contact.touching else 1))
    moved = math.hypot(place.x - contact.place.x, place.y - contact.place.y)
    turned = 0.0 if disc else abs(place.yaw - contact.place.yaw)
    return Contact(False, contact.touching and moved < _RELEASE and turned < _RELEASE, contact.place, contact.number)


@njit(cache=True, nogil=True)
def _dead_reckon(odometry: Place, driven: float, turned: float, error: OdometryError, normals: FloatArray) -> Place:
    distance, rotation = abs(driven), abs(turned)
    distance_variance = error.distance_per_metre * distance + error.distance_per_radian * rotation
    rotation_variance = error.rotation_per_radian * rotation + error.rotation_per_metre * distance
    return _arc(
        odometry,
        driven + math.sqrt(distance_variance) * normals[0],
        turned + math.sqrt(rotation_variance) * normals[1],
    )
