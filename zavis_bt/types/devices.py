"""What a device says of itself to somebody who looks after it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class DeviceReport:
    """A device's name plate and how it is doing."""

    model: str
    firmware: str = ""
    serial: str = ""
    figures: Mapping[str, str] = field(default_factory=dict)
    """Rates, latencies, voltages, counters: name → value with unit, in the order to be shown."""
    problems: tuple[str, ...] = ()
    """What is wrong, one line each with its remedy; empty if all is well."""
