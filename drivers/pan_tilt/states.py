"""The state machine of a CiA 402 drive: states in the statusword, and the way to operation."""

from __future__ import annotations

from enum import Enum

SHUTDOWN, SWITCH_ON, ENABLE_OPERATION, DISABLE_VOLTAGE, QUICK_STOP = 0x06, 0x07, 0x0F, 0x00, 0x02
"""Commands in the controlword's low bits."""


class State(Enum):
    """States of a drive: the mask and the value of the statusword, and how to call it."""

    NOT_READY = (0x4F, 0x00, "not ready to switch on")
    SWITCH_ON_DISABLED = (0x4F, 0x40, "switch on disabled")
    READY = (0x6F, 0x21, "ready to switch on")
    SWITCHED_ON = (0x6F, 0x23, "switched on")
    ENABLED = (0x6F, 0x27, "operation enabled")
    QUICK_STOP = (0x6F, 0x07, "quick stop active")
    FAULT_REACTION = (0x4F, 0x0F, "fault reaction active")
    FAULT = (0x4F, 0x08, "fault")

    @property
    def bits(self) -> int:
        """The statusword's bits that tell this state."""
        return self.value[1]

    @property
    def text(self) -> str:
        """Its name in the profile."""
        return self.value[2]

    @property
    def faulty(self) -> bool:
        """Whether the drive has a fault."""
        return self in (State.FAULT, State.FAULT_REACTION)


def decode_state(statusword: int) -> State | None:
    """Return the state that a statusword tells, or None if it tells none of the profile's."""
    for state in State:
        mask, value, _ = state.value
        if statusword & mask == value:
            return state
    return None


_TOWARDS_OPERATION = {
    State.SWITCH_ON_DISABLED: SHUTDOWN,
    State.READY: SWITCH_ON,
    State.SWITCHED_ON: ENABLE_OPERATION,
    State.ENABLED: ENABLE_OPERATION,
}


def towards_operation(state: State | None) -> int:
    """Return the controlword for the next step to operation; faults are not reset by it."""
    return DISABLE_VOLTAGE if state is None else _TOWARDS_OPERATION.get(state, DISABLE_VOLTAGE)
