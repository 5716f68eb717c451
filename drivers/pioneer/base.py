"""A Pioneer as a mission's base."""

from __future__ import annotations

import atexit
import threading
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from drivers.history import PoseHistory
from drivers.pioneer.cadence import Cadence
from drivers.pioneer.codec import (
    CommandNumber,
    PacketError,
    PacketType,
    Sip,
    decode_encoders,
    decode_sip,
    encode_command,
    is_sip,
)
from drivers.pioneer.connection import EMERGENCY_STOP, Connection, connect, say_farewell
from drivers.pioneer.health import Health
from drivers.pioneer.models import charge_share
from drivers.pioneer.motors import Motors
from drivers.pioneer.odometry import Odometry, twist_of
from drivers.pioneer.settings import PioneerSettings
from drivers.pioneer.sonar import Echo, merge
from drivers.settings import read_settings
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import DeviceContext
from zavis_bt.types import BaseState, DeviceReport, Pose2D, Twist2D

_POLL = 0.05  # [s]
_FIRST_SIP = 2.0  # after connecting [s]
_SWITCH_ON = 3.0  # the motors are on or have failed so soon after the first SIP [s]
_SHORTEST_PAUSE, _LONGEST_PAUSE = 0.2, 2.0  # between attempts to reconnect [s]
_REST_WITHIN = 1.0  # [s]
_AT_REST = 0.01  # [m/s, rad/s]
_JOIN = 3.0  # [s]
_ENABLE = encode_command(CommandNumber.ENABLE, 1)


class PioneerBase:
    """A Pioneer robot over ARCOS.

    One thread listens, keeps the latest state and reconnects; another sends velocities at a steady beat. `state` and
    `pose_at` only read what is there.
    """

    def __init__(self, settings: PioneerSettings, context: DeviceContext) -> None:
        """Connect, set the limits and switch the motors on.

        Raises:
            DeviceError: There is no Pioneer to connect to: one line with the remedy.
        """
        self._settings, self._context = settings, context
        self._closing = threading.Event()
        self._ready = threading.Event()
        self._connection = self._connect()
        self._odometry, self._history = Odometry(context.start), PoseHistory()
        self._motors, self._health = Motors(), Health(settings.rate, context.spec.limits)
        self._cadence = Cadence(1 / settings.rate, settings.command_timeout)
        self._state = BaseState(context.start, Twist2D(), context.clock.now())
        self._echoes: tuple[Echo, ...] = ()
        self._failure: DeviceError | None = None
        self._listener = threading.Thread(target=self._run, name="pioneer listener", daemon=True)
        atexit.register(self.close)
        self._listener.start()
        self._ready.wait(_FIRST_SIP + _SWITCH_ON)
        if self._health.packets == 0:
            self.close()
            raise self._failure or DeviceError(f"{self._place}: connected, but tells nothing")

    def state(self) -> BaseState:
        """Return the latest state; while the link is lost its stamp stands still and ``fault`` says why."""
        return self._state

    def pose_at(self, stamp: float) -> Pose2D:
        """Return the odometry pose at a time within the last seconds [s]."""
        return self._history.at(stamp)

    def sonar(self) -> tuple[Echo, ...]:
        """Return the latest reading of each sonar transducer, by number."""
        return self._echoes

    def command(self, twist: Twist2D) -> None:
        """Drive with this velocity, clipped to the limits; halt if no further command comes within the time-out.

        While the motors are off nothing is sent, and nothing kept for later.

        Raises:
            DeviceError: The link is lost.
            ValueError: It is not a velocity: not finite.
        """
        if not self._cadence.set(*self._connection.bounds.units(twist)):
            raise DeviceError(self._state.fault or f"{self._place}: is not connected")

    def stop(self) -> None:
        """Send an emergency stop at once, and no velocity until the next `command`; never raises."""
        self._cadence.stop()

    def report(self) -> DeviceReport:
        """Return the robot's name plate, rates and counters, and what is wrong with it."""
        connection, fault = self._connection, self._state.fault
        identity, config = connection.met.identity, connection.met.config
        problems = tuple(self._health.problems(connection, self._odometry))
        return DeviceReport(
            model=f"{identity.class_name} {identity.subclass} '{identity.name}'",
            firmware=config.firmware if config else "",
            serial=config.serial_number if config else "",
            figures=self._health.figures(connection, self._cadence),
            problems=(fault, *problems) if fault else problems,
        )

    def close(self) -> None:
        """Bring the base to rest, switch the motors off, end the connection; never raises, may be called twice."""
        if self._closing.is_set():
            return
        atexit.unregister(self.close)
        self._come_to_rest()
        self._closing.set()
        self._cadence.close()
        self._listener.join(_JOIN)

    @property
    def _place(self) -> str:
        return f"{self._context.where}: {self._settings.port}"

    def _connect(self) -> Connection:
        limits, where = self._context.spec.limits, self._context.where
        return connect(self._settings, limits, where, self._closing.is_set)

    def _run(self) -> None:
        connection: Connection | None = self._connection
        while connection is not None:
            self._connection = connection
            try:
                self._listen(connection)
            except DeviceError as error:
                self._cadence.bar(True)
                self._lose(error)
            self._cadence.detach(EMERGENCY_STOP)
            self._health.end(connection)
            say_farewell(connection.line)
            connection = self._reconnect()

    def _listen(self, connection: Connection) -> None:
        """Take what the robot tells until the driver is closed.

        Raises:
            DeviceError: The link is lost.
        """
        self._motors = Motors()
        self._odometry.resume()
        self._health.begin()
        connection.prepare(self._settings.sonar)
        self._cadence.attach(connection.line.write)
        heard, patience = time.monotonic(), _FIRST_SIP
        while not self._closing.is_set():
            for payload in connection.line.read(_POLL):
                if is_sip(payload) and self._take(payload, connection):
                    heard, patience = time.monotonic(), self._settings.silence
                elif payload[0] == PacketType.ENCODER:
                    self._take_encoders(payload, connection)
            if self._cadence.failure is not None:
                raise self._cadence.failure
            if time.monotonic() - heard > patience:
                raise DeviceError(f"{self._place}: silent for {patience:g} s (is the robot on, and its cable in?)")

    def _take(self, payload: bytes, connection: Connection) -> bool:
        """Take a SIP; return whether it made sense."""
        stamp = self._context.clock.now()
        try:
            sip = decode_sip(payload)
        except PacketError:
            self._health.malformed += 1
            return False
        self._health.heard(time.monotonic())
        if self._motors.update(sip):
            self._cadence.say(_ENABLE)
        self._cadence.bar(self._motors.stop_pressed or not self._motors.on)
        pose, twist = self._odometry.update(sip, stamp, connection.parameters), twist_of(sip, connection.parameters)
        self._history.add(stamp, pose, twist)
        self._echoes = merge(self._echoes, sip, stamp, connection.parameters)
        self._publish(sip, pose, twist, stamp)
        return True

    def _take_encoders(self, payload: bytes, connection: Connection) -> None:
        try:
            encoders = decode_encoders(payload)
        except PacketError:
            self._health.malformed += 1
            return
        if connection.ticks_per_mm:
            stamp = self._context.clock.now()
            self._odometry.bridge(encoders, stamp, connection.parameters, connection.ticks_per_mm)

    def _publish(self, sip: Sip, pose: Pose2D, twist: Twist2D, stamp: float) -> None:
        """Make this the latest state; the fault of a lost link stays until motors and pose are settled."""
        self._health.voltage = voltage = (sip.battery_x10 or sip.battery) / 10
        motors = self._motors
        settled = motors.settled and self._odometry.settled
        self._state = BaseState(
            pose=pose,
            twist=twist,
            stamp=stamp,
            battery=sip.charge_percent / 100 if sip.charge_percent else charge_share(voltage),
            bumper=bool(sip.front_bumpers or sip.rear_bumpers),
            stalled=sip.left_stalled or sip.right_stalled,
            estop=motors.stop_pressed,
            fault=motors.fault if settled else self._state.fault,
        )
        if settled:
            self._ready.set()

    def _lose(self, error: DeviceError) -> None:
        """Say that the link is lost, and why."""
        self._failure = error
        self._state = replace(self._state, fault=f"{error}; reconnecting")
        self._ready.set()

    def _reconnect(self) -> Connection | None:
        """Return a new connection, after as many attempts as it takes; None if the driver is closed meanwhile."""
        pause = _SHORTEST_PAUSE
        while not self._closing.wait(pause):
            pause = min(2 * pause, _LONGEST_PAUSE)
            try:
                connection = self._connect()
            except DeviceError as error:
                self._lose(error)
                continue
            self._health.reconnects += 1
            return connection
        return None

    def _come_to_rest(self) -> None:
        """Stop, and give the base a moment: motors that are switched off while it moves let it coast."""
        self._cadence.stop()
        deadline = time.monotonic() + _REST_WITHIN
        while self._is_moving() and time.monotonic() < deadline:
            time.sleep(_POLL / 2)

    def _is_moving(self) -> bool:
        twist, fault = self._state.twist, self._state.fault
        return not fault and max(abs(twist.linear), abs(twist.angular)) > _AT_REST


def open_base(settings: Mapping[str, Any], context: DeviceContext) -> PioneerBase:
    """Connect to a Pioneer, as the driver ``pioneer`` of a robot file's base.

    Args:
        settings: See `PioneerSettings`.
        context: Place in the robot file, model, clock and start.

    Raises:
        InputError: A setting is wrong.
        DeviceError: There is no Pioneer to connect to: one line with the remedy.
    """
    return PioneerBase(read_settings(PioneerSettings, settings, context.where), context)
