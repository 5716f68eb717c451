"""Whether the motors are on, and what to do and say if not."""

from __future__ import annotations

from drivers.pioneer.codec import Flags, Sip

_PATIENCE = 12  # SIPs until it is given up to switch the motors on
_PRESSED = "the STOP button is pressed (release it, then press the robot's white MOTORS button)"
_REFUSED = "the motors do not go on (is the charger plugged in, or the battery empty? press the white MOTORS button)"
_STOPPED = "the STOP button has switched the motors off (press the robot's white MOTORS button to go on)"
_DISABLED = "somebody has switched the motors off (press the robot's white MOTORS button to go on)"


class Motors:
    """Follows the flags of the SIPs since connecting.

    The driver switches the motors on after connecting, once; whoever switches them off later must mean it.
    """

    def __init__(self) -> None:
        self.on = False
        """Whether they are on now."""
        self.stop_pressed = False
        """Whether the emergency stop is pressed now."""
        self.settled = False
        """Whether they have been on, or it was given up."""
        self.fault = ""
        """Why the base cannot move, with the remedy."""
        self._asked = 0
        self._worked = self._was_pressed = False

    def update(self, sip: Sip) -> bool:
        """Take a SIP; return whether ENABLE should be sent again."""
        self.on = bool(sip.flags & Flags.MOTORS_ENABLED)
        self.stop_pressed = bool(sip.flags & Flags.STOP_PRESSED)
        self._worked = self._worked or self.on
        self._was_pressed = not self.on and (self._was_pressed or self.stop_pressed)
        self._asked += 1
        self.settled = self.settled or self.on or self.stop_pressed or self._asked > _PATIENCE
        self.fault = self._judge() if self.settled else ""
        return not self.settled and self._asked % 3 == 0

    def _judge(self) -> str:
        if self.stop_pressed:
            return _PRESSED
        if self.on:
            return ""
        if self._was_pressed:
            return _STOPPED
        return _DISABLED if self._worked else _REFUSED
