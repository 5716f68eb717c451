from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.pan_tilt.states import State, decode_state
from sim.devices.cia402.machine import StateMachine

DISABLED, READY, ON, ENABLED = State.SWITCH_ON_DISABLED, State.READY, State.SWITCHED_ON, State.ENABLED
QUICK, FAULT, REACTION = State.QUICK_STOP, State.FAULT, State.FAULT_REACTION

# What the profile says becomes of each state by: shutdown, switch on, enable operation, disable voltage, quick stop.
COMMANDS = (0x06, 0x07, 0x0F, 0x00, 0x02)
TABLE = {
    DISABLED: (READY, DISABLED, DISABLED, DISABLED, DISABLED),
    READY: (READY, ON, ENABLED, DISABLED, DISABLED),
    ON: (READY, ON, ENABLED, DISABLED, DISABLED),
    ENABLED: (READY, ON, ENABLED, DISABLED, QUICK),
    QUICK: (QUICK, QUICK, ENABLED, DISABLED, QUICK),
    FAULT: (FAULT,) * 5,
    REACTION: (REACTION,) * 5,
}


@pytest.mark.parametrize("state", TABLE, ids=lambda state: state.text)
def test_each_command_leads_where_the_profile_says(state: State) -> None:
    for command, expected in zip(COMMANDS, TABLE[state], strict=True):
        machine = StateMachine()
        machine.state = state
        machine.control(command)
        assert machine.state is expected, f"{command:02X} in {state.text}"


def test_a_fault_is_reset_by_a_rising_edge_alone() -> None:
    machine = StateMachine()
    machine.control(0x80)
    machine.fail()
    machine.came_to_rest(stay=False)
    machine.control(0x80)
    assert machine.state is FAULT
    machine.control(0x00)
    machine.control(0x80, fault_gone=False)
    assert machine.state is FAULT
    machine.control(0x00)
    machine.control(0x80)
    assert machine.state is DISABLED


def test_at_rest_a_quick_stop_ends_or_stays_as_its_option_says() -> None:
    for stay, expected in ((True, QUICK), (False, DISABLED)):
        machine = StateMachine()
        machine.state = QUICK
        machine.came_to_rest(stay=stay)
        assert machine.state is expected


@given(st.lists(st.one_of(st.integers(0, 0xFFFF), st.sampled_from(["fail", "rest"])), max_size=60))
def test_operation_is_entered_from_ready_on_or_quick_stop_only(events: list[int | str]) -> None:
    machine = StateMachine()
    for event in events:
        before = machine.state
        if event == "fail":
            machine.fail()
        elif event == "rest":
            machine.came_to_rest(stay=False)
        else:
            machine.control(int(event))
        if machine.state is ENABLED and before is not ENABLED:
            assert before in (READY, ON, QUICK)
        if before is FAULT:
            assert machine.state in (FAULT, DISABLED)


@given(st.integers(0, 0xFFFF))
def test_a_statusword_tells_one_state_at_most_and_its_own_bits_tell_it(word: int) -> None:
    matches = [state for state in State if word & state.value[0] == state.bits]
    assert len(matches) <= 1
    assert decode_state(word) is (matches[0] if matches else None)
    for state in State:
        assert decode_state(state.bits | 0xFF90) is state
