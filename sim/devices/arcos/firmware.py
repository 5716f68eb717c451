"""The firmware of the simulated robot: connection, watchdog, commands in, packets out. It knows no line."""

from __future__ import annotations

import threading
from typing import NamedTuple, Protocol

from drivers.pioneer.codec import Command, CommandNumber, Identity, decode_command, encode_config, encode_sip
from sim.devices.arcos.commands import obey
from sim.devices.arcos.controller import Controller
from sim.devices.arcos.handshake import Handshake, Phase
from sim.devices.arcos.model import P3AT, PioneerModel
from sim.devices.arcos.odometer import Odometer
from sim.devices.arcos.telemetry import configuration, extras, information
from sim.devices.plant import Plant


class Line(Protocol):
    """What a client is connected through."""

    @property
    def present(self) -> bool:
        """Whether somebody is at the other end, as far as the line can tell."""


class Reply(NamedTuple):
    """What the robot does about a packet."""

    packets: bytes = b""
    """To be sent back."""
    closed: bool = False
    """Whether this has ended the connection."""


class Firmware:
    """Plays one robot's micro-controller. All methods may be called by any thread.

    It works as a controller of the plant: before each step it decides what the wheels do. It serves one client at a
    time, whatever line that comes through.
    """

    def __init__(self, plant: Plant, model: PioneerModel = P3AT, *, watchdog: float = 1.0) -> None:
        """Take over the plant's wheels, and wait for a client.

        Args:
            plant: The robot's body.
            model: What kind of Pioneer it is.
            watchdog: Silence of the client after which the robot stops [s]; 0 = never.
        """
        self.model, self.watchdog = model, watchdog
        self._plant, self._lock = plant, threading.RLock()
        self._identity = Identity(model.config.name, model.config.class_name, model.config.subclass)
        self._odometer = Odometer(model, plant.motion)
        self._line: Line | None = None
        self._heard = plant.now
        self._silenced = False
        self._begin()
        plant.controllers.append(self.step)

    @property
    def phase(self) -> Phase:
        """What it waits for."""
        return self._handshake.phase

    @property
    def controller(self) -> Controller:
        """State of the present connection."""
        return self._controller

    def claim(self, line: Line) -> bool:
        """Let a line serve its client; return False while another one does."""
        with self._lock:
            if self._line is not line and self._line is not None and self._line.present:
                return False
            if self._line is not line:
                self._line = line
                self._begin()
            return True

    def is_held_by(self, line: Line) -> bool:
        """Return whether the robot serves this line's client."""
        return self._line is line

    def release(self, line: Line) -> None:
        """End the connection of a line and let others have the robot; does nothing if the line does not have it."""
        with self._lock:
            if self._line is line:
                self._line = None
                self._begin()

    def receive(self, payload: bytes) -> Reply:
        """Take a valid packet of the client."""
        with self._lock:
            if not self._handshake.finished:
                return self._synchronise(payload)
            self._heard, self._silenced = self._plant.now, False
            return self._command(decode_command(payload))

    def report(self) -> bytes:
        """Return what the robot sends by itself once in `PioneerModel.period`; nothing while it is silent."""
        with self._lock:
            if self.phase is not Phase.CLOSE:
                return b""
            return encode_sip(information(self._controller)) + extras(self._controller)

    def step(self, now: float) -> None:
        """Work for the next step of the world, at a time [s]."""
        with self._lock:
            self._odometer.step(self._plant.motion)
            if self.watchdog and not self._silenced and now - self._heard > self.watchdog:
                self._silenced = True
                self._controller.drive.stop()
            self._controller.step(now)

    def _begin(self) -> None:
        """Forget the client: stop, motors off, stored defaults, wait for SYNC0."""
        self._handshake = Handshake(self._identity)
        self._controller = Controller(self._plant, self.model, self._odometer)

    def _synchronise(self, payload: bytes) -> Reply:
        reply = self._handshake.answer(payload)
        if self._handshake.finished:
            self._heard, self._silenced = self._plant.now, False
            self._odometer.zero(self._plant.motion)
        return Reply(reply)

    def _command(self, command: Command) -> Reply:
        if command.number in (CommandNumber.CLOSE, CommandNumber.RESET):
            self._begin()
            return Reply(closed=True)
        if command.number == CommandNumber.OPEN:
            self._handshake.phase = Phase.CLOSE
        elif command.number == CommandNumber.CONFIG:
            return Reply(encode_config(configuration(self._controller, self.watchdog)))
        else:
            obey(self._controller, command)
        return Reply()
