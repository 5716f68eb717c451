"""A pressed bumper or a stalled wheel: stop, then only away from what was met, slowly."""

from __future__ import annotations

from zavis_bt.types import BaseState, Footprint, Twist2D


class Contact:
    """Remembers which way the base went when it met something."""

    def __init__(self, footprint: Footprint, creep: float) -> None:
        """Allow no part of the footprint to move faster than ``creep`` [m/s] while there is contact."""
        self._creep, self._turn = creep, creep / footprint.circumscribed_radius
        self._away = -1.0
        self.reason = ""
        """``bumper`` or ``stall`` while there is contact."""

    def begins(self, state: BaseState, sent: Twist2D) -> bool:
        """Note the base's switches and what it was told last; return whether a contact is new."""
        touched, self.reason = bool(self.reason), _reason(state)
        new = bool(self.reason) and not touched
        if new:
            self._away = 1.0 if sent.linear < 0 else -1.0
        return new

    def back_off(self, asked: Twist2D) -> Twist2D:
        """Return what of a twist leads away from what was met."""
        away = min(max(asked.linear * self._away, 0.0), self._creep)
        return Twist2D(away * self._away, min(max(asked.angular, -self._turn), self._turn))


def _reason(state: BaseState) -> str:
    return "bumper" if state.bumper else ("stall" if state.stalled else "")
