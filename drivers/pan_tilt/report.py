"""What a pan-tilt unit says to somebody who looks after it."""

from __future__ import annotations

import math
import time

from drivers.pan_tilt.axis import Axis
from drivers.pan_tilt.emergencies import describe
from drivers.pan_tilt.pace import quantile
from drivers.pan_tilt.settings import PanTiltSettings
from drivers.pan_tilt.unit import Unit
from zavis_bt.types import DeviceReport

_JITTER = 0.25  # share of the period from which on the beat is unsteady
_LISTED = 3


def describe_unit(unit: Unit, settings: PanTiltSettings, fault: str, faults: int) -> DeviceReport:
    """Return the report on a unit.

    Args:
        unit: The drives.
        settings: Of them.
        fault: Present one, or empty.
        faults: How many there were.
    """
    names = tuple(str(identity) for identity in unit.identities)
    return DeviceReport(
        model=" + ".join(dict.fromkeys(names)),
        firmware=", ".join(dict.fromkeys(identity.software for identity in unit.identities if identity.software)),
        serial=", ".join(str(identity.serial) for identity in unit.identities),
        figures=_figures(unit, settings, faults),
        problems=tuple(_problems(unit, fault)),
    )


def _figures(unit: Unit, settings: PanTiltSettings, faults: int) -> dict[str, str]:
    pace, latencies = unit.pace, unit.latencies
    figures = {
        "bus": f"{settings.interface} {settings.channel}",
        "mode": settings.mode,
        "cycle": f"{1 / pace.period:.0f} Hz, late by {pace.lateness(0.5) * 1e3:.2f} ms (median), "
        f"{pace.lateness(0.99) * 1e3:.2f} ms (99 %), {pace.lost} lost",
        "SYNC to measurement": f"{quantile(latencies, 0.5) * 1e3:.2f} ms (median), "
        f"{quantile(latencies, 0.99) * 1e3:.2f} ms (99 %)",
    }
    for axis in unit.axes:
        figures[str(axis)] = _describe_axis(axis)
    figures["faults"] = str(faults)
    return figures


def _describe_axis(axis: Axis) -> str:
    state = axis.state.text if axis.state else "no known state"
    age = time.monotonic() - axis.beaten
    beat = f"heartbeat {age:.2f} s ago" if math.isfinite(age) else "no heartbeat"
    text = f"{math.degrees(axis.angle):.2f}°, {state}, {beat}"
    latest = list(axis.emergencies)[-_LISTED:]
    if latest:
        now = time.monotonic()
        text += "; " + ", ".join(
            f"{describe(code) if code else 'errors cleared'} {now - moment:.0f} s ago" for moment, code in latest
        )
    return text


def _problems(unit: Unit, fault: str) -> list[str]:
    problems = [fault] if fault else []
    problems += [f"{axis} warns: {describe(axis.emergency)}" for axis in unit.axes if axis.emergency and not fault]
    late = unit.pace.lateness(0.99)
    if late > _JITTER * unit.pace.period:
        problems.append(f"the cycle is late by {late * 1e3:.1f} ms at times (is this computer overloaded?)")
    return problems
