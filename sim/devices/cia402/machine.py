"""The drive's side of the CiA 402 state machine."""

from __future__ import annotations

from drivers.pan_tilt.objects import FAULT_RESET
from drivers.pan_tilt.states import (
    DISABLE_VOLTAGE,
    ENABLE_OPERATION,
    QUICK_STOP,
    SHUTDOWN,
    SWITCH_ON,
    State,
)

TRANSITIONS: dict[State, dict[int, State]] = {
    State.SWITCH_ON_DISABLED: {SHUTDOWN: State.READY},
    State.READY: {
        SWITCH_ON: State.SWITCHED_ON,
        ENABLE_OPERATION: State.ENABLED,  # through switched on
        DISABLE_VOLTAGE: State.SWITCH_ON_DISABLED,
        QUICK_STOP: State.SWITCH_ON_DISABLED,
    },
    State.SWITCHED_ON: {
        ENABLE_OPERATION: State.ENABLED,
        SHUTDOWN: State.READY,
        DISABLE_VOLTAGE: State.SWITCH_ON_DISABLED,
        QUICK_STOP: State.SWITCH_ON_DISABLED,
    },
    State.ENABLED: {
        SWITCH_ON: State.SWITCHED_ON,
        SHUTDOWN: State.READY,
        DISABLE_VOLTAGE: State.SWITCH_ON_DISABLED,
        QUICK_STOP: State.QUICK_STOP,
    },
    State.QUICK_STOP: {DISABLE_VOLTAGE: State.SWITCH_ON_DISABLED, ENABLE_OPERATION: State.ENABLED},
}
"""By state and command; what is not named changes nothing."""


def command_in(controlword: int) -> int:
    """Return the command in the low bits of a controlword, the don't-care bits removed."""
    if not controlword & 0x02:
        return DISABLE_VOLTAGE
    if not controlword & 0x04:
        return QUICK_STOP
    if not controlword & 0x01:
        return SHUTDOWN
    return ENABLE_OPERATION if controlword & 0x08 else SWITCH_ON


class StateMachine:
    """State of one drive after what it was told and what befell it."""

    def __init__(self) -> None:
        self.state = State.SWITCH_ON_DISABLED
        self.controlword = 0
        """As last given."""

    def control(self, controlword: int, *, fault_gone: bool = True) -> None:
        """Take a controlword; a fault is reset by a rising edge of its bit if ``fault_gone``."""
        rising = controlword & ~self.controlword
        self.controlword = controlword
        if self.state is State.FAULT:
            if rising & FAULT_RESET and fault_gone:
                self.state = State.SWITCH_ON_DISABLED
            return
        self.state = TRANSITIONS.get(self.state, {}).get(command_in(controlword), self.state)

    def fail(self) -> None:
        """Begin the reaction to a fault; nothing new in a fault."""
        if not self.state.faulty:
            self.state = State.FAULT_REACTION

    def came_to_rest(self, *, stay: bool) -> None:
        """End a fault reaction or, unless it is to ``stay``, a quick stop."""
        if self.state is State.FAULT_REACTION:
            self.state = State.FAULT
        elif self.state is State.QUICK_STOP and not stay:
            self.state = State.SWITCH_ON_DISABLED
