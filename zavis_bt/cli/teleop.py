"""What keys mean for a robot: motion that lasts only while a key is held."""

from __future__ import annotations

import math
from dataclasses import dataclass

from zavis_bt.cli.keyboard import KEY_ESCAPE
from zavis_bt.types import BaseLimits, Twist2D

DRIVE = {
    "w": (1, 0), "up": (1, 0), "s": (-1, 0), "down": (-1, 0),
    "a": (0, 1), "left": (0, 1), "d": (0, -1), "right": (0, -1),
}  # fmt: skip
"""Key → forward and left, each −1, 0 or 1."""
LOOK = {"j": (1, 0), "l": (-1, 0), "i": (0, 1), "k": (0, -1)}
"""Key → pan to the left and tilt up, each −1, 0 or 1."""
FASTER, SLOWER, LEVEL, LEAVE = ("+", "="), ("-", "_"), ("h",), ("q", KEY_ESCAPE)

_FIRST, _LEAST, _MOST, _FACTOR = 0.15, 0.05, 0.3, 1.25  # speed [m/s] and how a key changes it
_TURN = math.radians(200)  # turning rate for a speed [rad/m]: 30 degrees a second at first
LOOK_STEP = math.radians(5)


@dataclass(frozen=True, slots=True)
class Look:
    """A wish to turn the camera: by steps from where it is, or back to level."""

    pan: float
    """[rad]"""
    tilt: float
    """[rad]"""
    level: bool = False


class Teleop:
    """Turns keys into a velocity, with a dead-man's switch.

    A terminal tells of keys that go down and repeats them while they are held, but not that they come up. So motion
    ends when no key has been heard of for ``hold`` seconds.
    """

    def __init__(self, limits: BaseLimits, hold: float = 0.5) -> None:
        """Begin at rest.

        Args:
            limits: Of the base; the speeds stay within them.
            hold: How long a key works after it was last heard of [s].
        """
        self._limits, self._hold = limits, hold
        self._fastest = min(_MOST, limits.max_linear)
        self.speed = min(_FIRST, self._fastest)
        """Speed while a key is held [m/s]."""
        self.left = False
        """Whether a key to leave was pressed."""
        self.stop_now = False
        """Whether the latest key that was no wish to move or look asks to stop as fast as possible."""
        self._direction, self._heard = (0, 0), -math.inf

    @property
    def turn(self) -> float:
        """Turning rate while a key is held [rad/s]."""
        return min(self.speed * _TURN, self._limits.max_angular)

    def press(self, key: str, now: float) -> Look | None:
        """Take a key that was heard of at ``now`` [s].

        Returns:
            Where to turn the camera, if the key says so. A key without a meaning stops the base at once.
        """
        if key in FASTER or key in SLOWER:
            factor = _FACTOR if key in FASTER else 1 / _FACTOR
            self.speed = min(max(self.speed * factor, min(_LEAST, self._fastest)), self._fastest)
            return None
        if key in LOOK:
            left, up = LOOK[key]
            return Look(left * LOOK_STEP, up * LOOK_STEP)
        if key in LEVEL:
            return Look(0.0, 0.0, level=True)
        self.left |= key in LEAVE
        self.stop_now = key not in DRIVE
        self._direction, self._heard = DRIVE.get(key, (0, 0)), now
        return None

    def twist(self, now: float) -> Twist2D | None:
        """Return the velocity wanted at ``now`` [s]; None to stand still."""
        forward, turn = self._direction
        if self.left or now - self._heard > self._hold or not (forward or turn):
            return None
        linear = forward * (self.speed if forward > 0 else min(self.speed, self._limits.max_reverse))
        return Twist2D(linear, turn * self.turn)
