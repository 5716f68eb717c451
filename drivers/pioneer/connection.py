"""A connection to a robot, from opening the port to motors that are on, and its orderly end."""

from __future__ import annotations

import contextlib
import time
from dataclasses import dataclass

from drivers.link import Link
from drivers.pioneer.codec import BAUD_CODES, CommandNumber, Config, encode_command
from drivers.pioneer.handshake import Acquaintance, NotAnswering, Stopped, get_acquainted
from drivers.pioneer.limits import Bounds, bounds_of
from drivers.pioneer.line import PacketLine
from drivers.pioneer.models import Parameters, parameters_of
from drivers.pioneer.settings import PioneerSettings
from zavis_bt.errors import DeviceError
from zavis_bt.types import BaseLimits

_OTHER_BAUDS = (9600, 38400, 19200, 115200, 57600)
_OTHER_TRIES = 2
_SWITCH_WAIT = 0.9  # after a change of speed [s]
_GAP = 0.005  # the controller wants so much time for a command [s]
_STREAM = 2  # encoder packets with every SIP
_GOODBYE = 0.3  # [s]
HALT = encode_command(CommandNumber.VEL, 0) + encode_command(CommandNumber.RVEL, 0)
"""Come to rest with normal braking."""
EMERGENCY_STOP = HALT + encode_command(CommandNumber.E_STOP)
"""Come to rest as hard as the base can, with nothing to resume afterwards."""
FAREWELL = HALT + encode_command(CommandNumber.ENABLE, 0) + encode_command(CommandNumber.CLOSE, 1)
"""Last words on every exit."""


@dataclass(frozen=True, slots=True)
class Connection:
    """A robot that is connected and sends SIPs."""

    line: PacketLine
    met: Acquaintance
    parameters: Parameters
    bounds: Bounds
    baud: int
    """Speed of a serial port; 0 on TCP."""

    @property
    def ticks_per_mm(self) -> int:
        """Of the wheel encoders; 0 if it is not known."""
        return self.met.config.ticks_per_mm if self.met.config else 0

    def prepare(self, sonar: bool) -> None:
        """Set the bounds and switch the motors on; the robot forgets both when it is closed.

        Raises:
            DeviceError: The line is broken.
        """
        last = (
            encode_command(CommandNumber.SONAR, int(sonar)),
            encode_command(CommandNumber.ENCODER, _STREAM if self.ticks_per_mm else 0),
            encode_command(CommandNumber.ENABLE, 1),
        )
        for command in (*self.bounds.commands(), *last):
            self.line.write(command)
            time.sleep(_GAP)


def say_farewell(line: PacketLine) -> None:
    """Tell the robot to end the connection, let that get out, and close the line; never raises."""
    with contextlib.suppress(DeviceError):
        line.write(FAREWELL)
        line.drain(_GOODBYE)
    line.link.close()


def connect(settings: PioneerSettings, limits: BaseLimits, where: str, stopped: Stopped) -> Connection:
    """Open the port and get acquainted with the robot there, at whatever speed it talks.

    Args:
        settings: Of the robot file.
        limits: Of the robot file.
        where: Place in the robot file, for messages.
        stopped: Whether to give up.

    Raises:
        DeviceError: The port cannot be opened, or there is no Pioneer: one line with the remedy.
    """
    link = Link(settings.port, baud=settings.baud, where=where)
    line = PacketLine(link)
    place = f"{where}: {settings.port}"
    try:
        met, baud = _try_speeds(line, settings, place, stopped)
        if met.config and settings.fast_baud and not link.is_tcp:
            baud = _speed_up(line, met.config, baud, settings.fast_baud, place)
    except BaseException:
        say_farewell(line)
        raise
    parameters = parameters_of(settings.subclass or met.identity.subclass)
    bounds = bounds_of(limits, settings.deceleration, parameters, met.config)
    return Connection(line, met, parameters, bounds, baud)


def _try_speeds(line: PacketLine, settings: PioneerSettings, where: str, stopped: Stopped) -> tuple[Acquaintance, int]:
    """Return what the robot told, and the speed it talks at (0 on TCP)."""
    try:
        return get_acquainted(line, where, stopped), 0 if line.link.is_tcp else settings.baud
    except NotAnswering as error:
        if line.link.is_tcp:
            raise
        first = error
    for baud in (other for other in _OTHER_BAUDS if other != settings.baud):
        if stopped():
            break
        line.link.set_baud(baud)
        with contextlib.suppress(NotAnswering):
            return get_acquainted(line, where, stopped, _OTHER_TRIES), baud
    raise first


def _speed_up(line: PacketLine, config: Config, slow: int, fast: int, where: str) -> int:
    """Change to the faster speed if the robot falls back by itself where that fails; return the speed now."""
    if config.autobaud < 2 or fast <= slow:
        return slow
    line.write(encode_command(CommandNumber.HOSTBAUD, BAUD_CODES[fast]))
    line.drain(0.05)  # the command must have left before the speed changes
    for baud in (fast, slow):
        line.link.set_baud(baud)
        line.write(encode_command(CommandNumber.PULSE))
        if line.read_one(_SWITCH_WAIT) is not None:
            return baud
    raise DeviceError(f"{where}: silent since the change to {fast} baud (set 'fast_baud' to null)")
