"""What is said to a sensor before it measures."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from drivers.lidar.clock import SensorClock
from drivers.lidar.codec import CodecError, Parameters, Request, decode_information, decode_number
from drivers.lidar.session import Session
from zavis_bt.errors import DeviceError
from zavis_bt.protocols import Clock

_EXCHANGES = 10
_SOUND = re.compile(r"\b(well|no error|normal|good|stable|ok)\b", re.IGNORECASE)
_ON = ("00", "02")  # done, and was so before


@dataclass(frozen=True, slots=True)
class NamePlate:
    """What a sensor says of itself."""

    parameters: Parameters
    version: Mapping[str, str]
    """The answer to VV; empty if there was none."""


def wake(session: Session) -> None:
    """End whatever the sensor is at, and bring an old one on a serial port to SCIP 2.0.

    The line feed ends a request that somebody may have left half-way.

    Raises:
        DeviceError: Nobody answers in SCIP 2.0.
    """
    stop = Request("QT")
    try:
        session.link.write(b"\n")
        if not session.link.is_tcp and session.try_to_ask(stop, timeout=0.3, tries=1) is None:
            session.link.write(Request("SCIP2.0").line + b"\n")
            session.drain(0.1, 0.5)
        answer = session.try_to_ask(stop)
    except DeviceError as error:
        raise DeviceError(f"{error} (a LiDAR serves one program at a time: does another use it?)") from error
    if answer is None:
        raise DeviceError(session.silence(stop))


def identify(session: Session) -> NamePlate:
    """Ask for version and parameters.

    Raises:
        DeviceError: There are no usable parameters.
    """
    version = session.try_to_ask(Request("VV"))
    try:
        parameters = Parameters.of(decode_information(session.ask(Request("PP")).lines))
    except CodecError as error:
        raise DeviceError(f"{session.place}: {error} (is it a LiDAR?)") from error
    return NamePlate(parameters, decode_information(version.lines) if version else {})


def synchronise(session: Session, clock: Clock) -> SensorClock:
    """Ask for the sensor's time, if it lets itself be asked.

    Raises:
        DeviceError: The line is broken.
    """
    exchanges: list[tuple[float, float, int]] = []
    entered = session.try_to_ask(Request("TM", "0"))
    while entered and entered.status in _ON and len(exchanges) < _EXCHANGES:
        asked = clock.now()
        answer = session.try_to_ask(Request("TM", "1"), tries=1)
        answered = clock.now()
        if answer is None or not answer.lines:
            break
        try:
            exchanges.append((asked, answered, decode_number(answer.lines[0])))
        except CodecError:
            break
    if entered:
        session.try_to_ask(Request("TM", "2"))
    return SensorClock(exchanges)


def switch_on(session: Session, *, high_sensitivity: bool) -> tuple[str, ...]:
    """Switch the laser on; return what the sensor says is wrong with it, one line each.

    Raises:
        DeviceError: The laser cannot be switched on.
    """
    problems = []
    if high_sensitivity:
        answer = session.try_to_ask(Request("HS", "1"))
        if answer is None or answer.status not in _ON:
            problems.append("it has no high sensitivity (remove the setting 'high_sensitivity')")
    status = session.ask(Request("BM"), timeout=2.0).status
    state = session.try_to_ask(Request("II"))
    told = decode_information(state.lines) if state else {}
    health = told.get("STAT", "")
    if status not in _ON:
        raise DeviceError(
            f"{session.place}: the laser cannot be switched on, status {status}"
            f"{f', {health!r}' if health else ''} (switch the sensor off and on again)"
        )
    if told.get("LASR", "ON").upper() == "OFF":
        problems.append("its laser is off (switch the sensor off and on again)")
    if health and not _SOUND.search(health):
        problems.append(f"it says of itself: {health!r} (see its manual)")
    return tuple(problems)
