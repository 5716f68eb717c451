"""The pan-tilt unit behind the safety layer."""

from __future__ import annotations

from dataclasses import replace

from zavis_bt.errors import DeviceError
from zavis_bt.protocols import PanTilt
from zavis_bt.types import PanTiltState


class SafePanTilt:
    """Remembers where the unit was sent: a move that failed or was held is made again, and until then not settled."""

    def __init__(self, unit: PanTilt) -> None:
        self._unit = unit
        self._target: tuple[float, float] | None = None
        self._owed = False
        self.trouble = ""
        """What the unit raised at the latest move; empty if it took it."""

    def state(self) -> PanTiltState:
        """Return the latest joint angles; not settled while a move is owed."""
        state = self._unit.state()
        return replace(state, settled=False) if self._owed else state

    def angles_at(self, stamp: float) -> tuple[float, float]:
        """Return pan and tilt [rad] at a time within the last second [s]."""
        return self._unit.angles_at(stamp)

    def move_to(self, pan: float, tilt: float) -> None:
        """Start a move to these angles [rad]; if the unit cannot be reached it is made when it can."""
        self._target = (pan, tilt)
        self._move(pan, tilt)

    def stop(self) -> None:
        """Come to rest and forget the move."""
        self._target, self._owed = None, False
        self._unit.stop()

    def hold(self) -> None:
        """Come to rest until `resume`."""
        self._owed = self._target is not None
        self._unit.stop()

    def resume(self) -> None:
        """Make the move that is owed."""
        self.trouble = ""
        if self._owed and self._target is not None:
            self._move(*self._target)

    def _move(self, pan: float, tilt: float) -> None:
        try:
            self._unit.move_to(pan, tilt)
        except DeviceError as error:
            self._owed, self.trouble = True, str(error)
        else:
            self._owed, self.trouble = False, ""
