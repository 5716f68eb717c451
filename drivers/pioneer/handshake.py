"""Getting acquainted: from an open line to a robot that has told its name and sends SIPs (protocol section 2)."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from drivers.pioneer.codec import (
    CommandNumber,
    Config,
    Identity,
    PacketType,
    decode_config,
    decode_identity,
    encode_command,
    encode_sync,
    is_sip,
)
from drivers.pioneer.codec.framing import HEADER
from drivers.pioneer.line import PacketLine
from zavis_bt.errors import DeviceError

_REPLY = 0.5  # waits for the answer to a SYNC [s]
_TRIES = 5
_SHAKE_AFTER = 3  # silent tries
_DRAIN = 0.15  # a robot that is not in step may say so much more [s]
_CONFIG_EVERY, _CONFIG_TRIES = 0.2, 5

Stopped = Callable[[], bool]
"""Says whether to give up, because the driver is being closed."""


@dataclass(frozen=True, slots=True)
class Acquaintance:
    """What a robot told on connecting."""

    identity: Identity
    config: Config | None
    """None if it did not answer CONFIG."""
    round_trip: float
    """Median time of a SYNC's answer [s]."""
    seconds: float
    """How long the handshake took [s]."""


class NotAnswering(DeviceError):
    """Nothing that a Pioneer would say came within the tries."""


def get_acquainted(line: PacketLine, where: str, stopped: Stopped, tries: int = _TRIES) -> Acquaintance:
    """Synchronise, open and ask for the configuration.

    Args:
        line: To the robot, in whatever state it is.
        where: To begin messages with: place in the robot file and port.
        stopped: Whether to give up.
        tries: How often to begin before it counts as not answering.

    Raises:
        NotAnswering: There is no robot, or something else.
        DeviceError: The line is broken.
    """
    begin = time.monotonic()
    silent = 0
    for _ in range(tries):
        if stopped():
            break
        met = _synchronise(line)
        if isinstance(met, tuple):
            identity, times = met
            _refuse_echo(identity, where)
            line.write(encode_command(CommandNumber.OPEN, 1))
            config = _ask_config(line, stopped)
            round_trip = sorted(times)[len(times) // 2]
            return Acquaintance(identity, config, round_trip, time.monotonic() - begin)
        silent = silent + 1 if met is None else 0
        _shake_loose(line, met, silent)
    raise NotAnswering(f"{where}: {judge(line.sample)}")


def judge(sample: bytes) -> str:
    """Say in plain words what somebody is who sent these bytes but no answer to the handshake."""
    if not sample:
        return "no answer (is the robot switched on and its cable plugged in, and is no other program connected to it?)"
    shown = " ".join(sample[:24].decode("ascii", errors="replace").split())
    printable = sum(32 <= byte < 127 or byte in b"\r\n\t" for byte in sample)
    if HEADER in sample:
        return "answers like a Pioneer, but never to the handshake (switch the robot off and on)"
    if printable >= 0.9 * len(sample):
        return f"answers, but not as a Pioneer: '{shown}' (is this the port of another device, such as the LiDAR?)"
    return f"answers, but not as a Pioneer: bytes {sample[:8].hex(' ')} (wrong 'baud', or another device?)"


def _synchronise(line: PacketLine) -> tuple[Identity, list[float]] | bytes | None:
    """Return the robot's name and the times of its answers, or an answer out of step, or None after silence."""
    times: list[float] = []
    reply: bytes | None = None
    for number in range(3):
        begin = time.monotonic()
        line.write(encode_sync(number))
        reply = line.read_one(_REPLY)
        if reply is None or reply[0] != number:
            return reply
        times.append(time.monotonic() - begin)
    return decode_identity(reply or b""), times


def _shake_loose(line: PacketLine, reply: bytes | None, silent: int) -> None:
    """Bring a robot back to the beginning that is still connected to somebody, or half way in a handshake."""
    if reply is not None and (is_sip(reply) or reply[0] == PacketType.CONFIG):
        line.write(encode_command(CommandNumber.CLOSE, 1))
    elif silent >= _SHAKE_AFTER:
        line.write(encode_command(CommandNumber.OPEN, 1))
    if reply is not None:
        line.drain(_DRAIN)


def _refuse_echo(identity: Identity, where: str) -> None:
    if not identity.class_name:
        raise NotAnswering(f"{where}: sends back what it is told and no name: not a Pioneer (is this the right port?)")


def _ask_config(line: PacketLine, stopped: Stopped) -> Config | None:
    """Return the configuration; None if the robot does not tell it."""
    for _ in range(_CONFIG_TRIES):
        if stopped():
            return None
        line.write(encode_command(CommandNumber.CONFIG, 1))
        deadline = time.monotonic() + _CONFIG_EVERY
        while (payload := line.read_one(deadline - time.monotonic())) is not None:
            if payload[0] == PacketType.CONFIG:
                return decode_config(payload)
    return None
