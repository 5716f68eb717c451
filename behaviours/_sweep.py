"""Looking around: moving the camera through a list of directions and taking a frame at each."""

from __future__ import annotations

import math
from collections.abc import Sequence

from zavis_bt.protocols import Robot
from zavis_bt.types import RgbdFrame, RobotSpec

_STANDSTILL = 0.02  # base speeds below which pictures are sharp [m/s, rad/s]


class CameraSweep:
    """Points the camera at one direction after the other; a frame counts if taken while everything stood still."""

    def __init__(self, robot: Robot, directions: Sequence[tuple[float, float]]) -> None:
        """Plan the sweep; nothing moves yet.

        Args:
            robot: Whose camera.
            directions: Pan and tilt of each frame [rad].
        """
        self._robot, self._directions = robot, list(directions)
        self._taken = 0
        self._commanded = False
        self._still_since: float | None = None

    @property
    def finished(self) -> bool:
        """Whether every frame was taken."""
        return self._taken == len(self._directions)

    @property
    def progress(self) -> str:
        """For example ``3/8``."""
        return f"{self._taken}/{len(self._directions)}"

    def poll(self) -> RgbdFrame | None:
        """Move on; call once a tick.

        Returns:
            The frame of the direction that was just completed, if one was.
        """
        if self.finished:
            return None
        if not self._commanded:
            self._robot.pan_tilt.move_to(*self._directions[self._taken])
            self._commanded, self._still_since = True, None
        if not self._still():
            self._still_since = None
            return None
        frame = self._robot.camera.frame()
        if self._still_since is None:
            self._still_since = self._robot.pan_tilt.state().stamp
        if frame is None or frame.stamp < self._still_since:
            return None
        self._taken += 1
        self._commanded = False
        return frame

    def _still(self) -> bool:
        twist = self._robot.base.state().twist
        moving = abs(twist.linear) > _STANDSTILL or abs(twist.angular) > _STANDSTILL
        return self._robot.pan_tilt.state().settled and not moving


def spread(centre: float, half_width: float, step: float, low: float, high: float) -> list[float]:
    """Return evenly spaced angles that cover ``centre ± half_width`` with views ``step`` wide.

    Args:
        centre: Middle of what is to be covered [rad].
        half_width: Half its extent [rad].
        step: Extent that one view covers [rad].
        low: Smallest angle the joint reaches [rad].
        high: Largest angle the joint reaches [rad].

    Returns:
        At least one angle, ascending, inside the joint's range.
    """
    count = max(math.ceil(2 * half_width / step - 1e-9), 1)
    width = 2 * half_width / count
    angles = [centre - half_width + (i + 0.5) * width for i in range(count)]
    return sorted({round(min(max(angle, low), high), 6) for angle in angles})


def sweep_directions(
    spec: RobotSpec, sector: float, overlap: float, tilts: Sequence[float]
) -> list[tuple[float, float]]:
    """Return the directions of a sweep across a sector straight ahead, from right to left and back with each tilt.

    Args:
        spec: Limits and camera.
        sector: Angle to cover [rad].
        overlap: Share of the field of view that neighbouring frames have in common, 0 to below 1.
        tilts: Tilt of each pass [rad].
    """
    fov = spec.camera.intrinsics.horizontal_fov
    limits = spec.pan_tilt
    pans = spread(0.0, sector / 2, fov * (1 - overlap), limits.pan_min, limits.pan_max)
    passes = (pans if i % 2 == 0 else pans[::-1] for i in range(len(tilts)))
    return [(pan, tilt) for tilt, order in zip(tilts, passes, strict=True) for pan in order]
