"""When motion is limited or refused: what a robot file's ``safety:`` section says."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SafetySettings:
    """Limits of the safety layer."""

    margin: float = 0.03
    """Distance that stays free ahead after braking [m]."""
    tolerance: float = 0.035
    """How far an obstacle may reach into the outline [m]: half a map cell and the LiDAR's error, since passages count
    as passable by cell centres."""
    deceleration: float | None = None
    """How fast the base surely slows down [m/s²]; None for its acceleration limit."""
    turn_deceleration: float | None = None
    """How fast a turn surely slows down [rad/s²]; None for its acceleration limit."""
    creep: float = 0.1
    """Speed with a pressed bumper, a stalled wheel, ticks that take too long, or in reverse where the LiDAR does not
    look [m/s]."""
    min_battery: float = 0.05
    """State of charge below which the base stands still, 0 to 1."""
    base_timeout: float = 0.25
    """Age of the base's state from which on it counts as lost [s]."""
    scan_timeout: float = 0.25
    """The same of the latest scan [s]; at least 2.5 of the LiDAR's periods."""
    pan_tilt_timeout: float = 0.25
    """The same of the pan-tilt unit's state [s]."""
    frame_timeout: float = 0.25
    """The same of the latest frame [s]; at least 2.5 of the camera's periods."""
    tick_limit: float = 0.3
    """Time from command to command beyond which a tick took too long [s]."""
    device_timeout: float = 10.0
    """How long a mission waits for a device that failed [s]."""
