"""One CiA 402 servo drive as a CANopen node."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

from drivers.pan_tilt.objects import (
    CONSUMER_HEARTBEAT,
    CONTROLWORD,
    ERROR_CODE,
    ERROR_HISTORY,
    ERROR_REGISTER,
    LIMIT_ACTIVE,
    MODE,
    MODE_DISPLAY,
    NMT_PRE_OPERATIONAL,
    NMT_RESET_COMMUNICATION,
    NMT_RESET_NODE,
    NMT_START,
    NMT_STOP,
    POSITION,
    QUICK_STOP_OPTION,
    REMOTE,
    SDO_ANSWER,
    STATUSWORD,
    SUPPORTED_MODES,
    TARGET_POSITION,
    TARGET_VELOCITY,
    VELOCITY,
    VOLTAGE,
    Mode,
)
from drivers.pan_tilt.states import State
from sim.devices.cia402.cyclic import CyclicPosition, CyclicVelocity
from sim.devices.cia402.faults import Faults
from sim.devices.cia402.homing import Homing, Switches
from sim.devices.cia402.machine import StateMachine
from sim.devices.cia402.modes import NoMode, Operation, ProfilePosition, ProfileVelocity
from sim.devices.cia402.pdo import ProcessData
from sim.devices.cia402.servo import Servo
from sim.devices.cia402.watch import HeartbeatWatch

_HEARTBEAT_LOST = 0x8130
_NMT_COMMANDS = (NMT_START, NMT_STOP, NMT_PRE_OPERATIONAL, NMT_RESET_NODE, NMT_RESET_COMMUNICATION)
_COAST, _STAYS_FROM = 0, 5
_BAD_VALUE = 0x0609_0030
_OUT_OF_STEP = struct.pack("<BHBI", 0x80, 0, 0, 0x0504_0001)  # abort: command not valid


class Drive:
    """State, modes and process data of a drive. One thread at a time may use it."""

    def __init__(self, node: Any, servo: Servo, switches: Switches, clock: Callable[[], float]) -> None:
        """Put a drive behind a ``canopen.LocalNode`` that belongs to a network; ``clock`` tells the time [s]."""
        self.node, self.servo = node, servo
        self._switches, self._clock = switches, clock
        self._machine = StateMachine()
        self._faults = Faults()
        self._watch = HeartbeatWatch()
        self._pdos = ProcessData(node)
        self._operation: Operation = NoMode(servo)
        self._mode = 0
        self._target_written = False
        node.add_read_callback(self._on_read)
        node.add_write_callback(self._on_write)

    @property
    def state(self) -> State:
        """Of the state machine."""
        return self._machine.state

    def boot(self) -> None:
        """Begin anew, as after the power is switched on; the shaft stays where it is."""
        self.node.data_store.clear()
        self._watch.clear()
        self._pdos.reset()
        self._machine = StateMachine()
        self._faults.reset()
        self._set_mode(0)
        self.servo.quick_stop(self._clock())
        self.node.nmt.stop_heartbeat()
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = "PRE-OPERATIONAL"

    def on_nmt(self, command: int, node: int) -> None:
        """Take an NMT command."""
        if node not in (0, self.node.id) or command not in _NMT_COMMANDS:
            return
        if command in (NMT_RESET_NODE, NMT_RESET_COMMUNICATION):
            self.boot()
            return
        before = self.node.nmt.state
        self.node.nmt.on_command(0, bytes([command, node]), 0.0)
        self._pdos.reset()
        if command == NMT_STOP and before != "STOPPED" and self._machine.state is State.ENABLED:
            self.servo.quick_stop(self._clock())
            self._machine.state = State.SWITCH_ON_DISABLED

    def on_sdo(self, data: bytes) -> None:
        """Take an SDO request."""
        if self.node.nmt.state != "STOPPED":
            try:
                self.node.sdo.on_request(0, bytearray(data), 0.0)
            except struct.error:  # the server cannot name the object of a transfer that was never begun
                self.node.network.send_message(SDO_ANSWER + self.node.id, _OUT_OF_STEP)
            self._take_target()

    def on_pdo(self, identifier: int, data: bytes) -> None:
        """Take process data."""
        if self._operational:
            self._pdos.receive(identifier, data)
            self._take_target()

    def on_heartbeat(self, node: int) -> None:
        """Note that another node lives."""
        self._watch.hear(node, self._clock())

    def on_sync(self) -> None:
        """Take the set-points of this cycle and send the measurements."""
        if not self._operational:
            return
        self._pdos.apply_waiting()
        self._take_target()
        if self._machine.state is State.ENABLED:
            self._operation.sync(self._clock())
        self._send(self._pdos.due_on_sync())

    def tick(self) -> None:
        """Do what is due; to be called every few milliseconds."""
        now = self._clock()
        if self._watch.lost(now):
            self.fail(_HEARTBEAT_LOST)
        if self._machine.state is State.ENABLED:
            self._operation.tick(now)
        elif self.servo.at_rest(now):
            self._machine.came_to_rest(stay=self.servo.value(QUICK_STOP_OPTION) >= _STAYS_FROM)
        if self._operational:
            self._send(self._pdos.due_by_event(now))

    def fail(self, code: int, seconds: float = 0.0) -> None:
        """Come down with a fault whose cause lasts some time [s]: tell of it, brake, and wait to be reset."""
        now = self._clock()
        self._faults.add(code, now + seconds)
        if not self._machine.state.faulty:
            self._machine.fail()
            self.servo.quick_stop(now)
        self._tell(code)

    @property
    def _operational(self) -> bool:
        return bool(self.node.nmt.state == "OPERATIONAL")

    def _take_target(self) -> None:
        """Tell the mode of a new target once it is in the dictionary, which is after the write's callback."""
        written, self._target_written = self._target_written, False
        if written and self._machine.state is State.ENABLED:
            self._operation.target(self._clock())

    def _tell(self, code: int) -> None:
        if self.node.nmt.state != "STOPPED":
            self.node.emcy.send(code, self._faults.register)

    def _send(self, frames: list[tuple[int, bytes]]) -> None:
        for identifier, data in frames:
            self.node.network.send_message(identifier, data)

    def _on_read(self, index: int, subindex: int, od: Any) -> int | None:
        if index == STATUSWORD:
            return self._statusword()
        if index in (POSITION, VELOCITY):
            return round(self.servo.at(self._clock())[index == VELOCITY])
        if index == MODE_DISPLAY:
            return self._mode
        if index in (ERROR_CODE, ERROR_REGISTER):
            return self._faults.code if index == ERROR_CODE else self._faults.register
        return self._faults.listed(subindex) if index == ERROR_HISTORY else None

    def _statusword(self) -> int:
        word = self._machine.state.bits | VOLTAGE | REMOTE
        if self._machine.state is State.ENABLED:
            word |= self._operation.status(self._clock())
        return word | self.servo.limited * LIMIT_ACTIVE

    def _on_write(self, index: int, subindex: int, od: Any, data: bytes) -> None:
        value = od.decode_raw(bytes(data))
        self._pdos.check_write(index, subindex, data)
        if index == CONTROLWORD:
            self._control(value)
        elif index == MODE:
            self._change_mode(value)
        elif index in (TARGET_POSITION, TARGET_VELOCITY):
            self._target_written = True
        elif index == CONSUMER_HEARTBEAT and subindex:
            self._watch.watch(subindex, value)
        elif index == ERROR_HISTORY:
            _require(value == 0)
            self._faults.forget()

    def _control(self, word: int) -> None:
        now, before, last = self._clock(), self._machine.state, self._machine.controlword
        self._machine.control(word, fault_gone=self._faults.gone(now))
        after = self._machine.state
        if before is State.FAULT and after is not before:
            self._faults.reset()
            self._tell(0)
        elif after is State.ENABLED:
            if before is not after:
                self._set_mode(self._mode)
                last = word  # bits that are up already are no edges
            self._operation.control(now, word, last)
        elif before in (State.ENABLED, State.QUICK_STOP) and after is not before:
            self._leave_operation(now, after)

    def _leave_operation(self, now: float, after: State) -> None:
        self.servo.quick_stop(now)
        if after is State.QUICK_STOP and self.servo.value(QUICK_STOP_OPTION) == _COAST:
            self._machine.came_to_rest(stay=False)

    def _change_mode(self, mode: int) -> None:
        _require(mode == 0 or (mode in tuple(Mode) and self.servo.value(SUPPORTED_MODES) & Mode(mode).bit != 0))
        if mode != self._mode:
            self._set_mode(mode)
            self._target_written = True  # modes that run to a target take it as it is
            if not self.servo.at_rest(self._clock()):
                self.servo.quick_stop(self._clock())

    def _set_mode(self, mode: int) -> None:
        self._mode = mode
        self.servo.limited = False
        if mode == Mode.HOMING:
            self._operation = Homing(self.servo, self._switches)
        else:
            self._operation = _MODES.get(mode, NoMode)(self.servo)


_MODES: dict[int, Callable[[Servo], Operation]] = {
    Mode.PROFILE_POSITION: ProfilePosition,
    Mode.PROFILE_VELOCITY: ProfileVelocity,
    Mode.CYCLIC_POSITION: CyclicPosition,
    Mode.CYCLIC_VELOCITY: CyclicVelocity,
}


def _require(good: bool) -> None:
    from canopen import SdoAbortedError

    if not good:
        raise SdoAbortedError(_BAD_VALUE)
