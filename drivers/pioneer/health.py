"""How the link and the robot are doing: figures and problems for a report."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Sequence
from itertools import pairwise

from drivers.pioneer.cadence import Cadence
from drivers.pioneer.connection import Connection
from drivers.pioneer.odometry import Odometry
from zavis_bt.types import BaseLimits

_WATCHDOG_LIMIT = 1000  # [ms]
_CORRUPTED_SHARE = 0.02
_RATE_SHARE = 0.8
_LOW_VOLTAGE = 11.5


class Health:
    """Counts what happens on the link, and puts it into words. One thread counts, any may ask."""

    def __init__(self, rate: float, limits: BaseLimits) -> None:
        """Begin to count.

        Args:
            rate: Wanted rate of velocities [Hz].
            limits: Of the robot file.
        """
        self._rate, self._limits = rate, limits
        self.reconnects = 0
        self.malformed = 0
        """Packets with a valid checksum that make no sense."""
        self.packets = 0
        """SIPs so far."""
        self.past_errors = 0
        """Checksum errors on earlier connections."""
        self.voltage = 0.0
        """Of the battery [V]."""
        self._arrivals: deque[float] = deque(maxlen=200)

    def heard(self, stamp: float) -> None:
        """Note that a SIP arrived [s]."""
        self.packets += 1
        self._arrivals.append(stamp)

    def begin(self) -> None:
        """Note a new connection: its rate is measured anew."""
        self._arrivals.clear()

    def end(self, connection: Connection) -> None:
        """Note the end of a connection."""
        self.past_errors += connection.line.decoder.checksum_errors

    def checksum_errors(self, connection: Connection) -> int:
        """Return how many there were on this and earlier connections."""
        return self.past_errors + connection.line.decoder.checksum_errors

    @property
    def sip_intervals(self) -> list[float]:
        """Between SIPs in a row [s]."""
        arrivals = tuple(self._arrivals)
        return [after - before for before, after in pairwise(arrivals)]

    def figures(self, connection: Connection, cadence: Cadence) -> dict[str, str]:
        """Return name and value of each figure, in the order to be shown."""
        config, sips, velocities = connection.met.config, self.sip_intervals, list(cadence.intervals)
        figures = {
            "battery": f"{self.voltage:.1f} V" if self.voltage else "unknown",
            "status packets": _rate(sips),
            "status jitter": _jitter(sips),
            "velocity commands": _rate(velocities) if velocities else f"{self._rate:.0f} Hz when moving",
            "velocity jitter": _jitter(velocities, 1 / self._rate),
            "round trip": f"{connection.met.round_trip * 1000:.1f} ms",
            "handshake": f"{connection.met.seconds:.2f} s",
            "robot's watchdog": f"{config.watchdog} ms" if config else "unknown",
            "checksum errors": str(self.checksum_errors(connection)),
            "reconnects": str(self.reconnects),
        }
        if connection.baud:
            figures["serial speed"] = f"{connection.baud} baud"
        return figures

    def problems(self, connection: Connection, odometry: Odometry) -> Iterator[str]:
        """Yield what is wrong, one line each with its remedy."""
        yield from self._of_robot(connection)
        yield from self._of_limits(connection)
        if 0 < self.voltage < _LOW_VOLTAGE:
            yield f"the battery is at {self.voltage:.1f} V (charge it)"
        errors = self.checksum_errors(connection)
        if errors > 10 and errors > _CORRUPTED_SHARE * self.packets:
            yield f"{errors} corrupted packets (check the cable, its length and the serial speed)"
        if self.malformed:
            yield f"{self.malformed} packets made no sense (check the robot's firmware)"
        if odometry.jumps:
            yield f"the odometry jumped {odometry.jumps} times and the jumps were left out (does the robot restart?)"

    def _of_robot(self, connection: Connection) -> Iterator[str]:
        identity, config = connection.met.identity, connection.met.config
        if not connection.parameters.known:
            name = f"{identity.class_name} {identity.subclass}"
            yield f"'{name}' is of no known family and taken as a p3at-sh (name one with the setting 'subclass')"
        if config is None:
            yield "the robot does not tell its configuration: watchdog and limits are unknown (update its firmware)"
            return
        if config.watchdog == 0:
            yield "the robot's watchdog is off: it drives on if this computer dies (set it to 1000 ms with ARCOScf)"
        elif config.watchdog > _WATCHDOG_LIMIT:
            yield (
                f"the robot's watchdog is {config.watchdog} ms: it drives on for so long if this computer dies"
                f" (set it to {_WATCHDOG_LIMIT} ms with ARCOScf)"
            )
        intervals = self.sip_intervals
        if len(intervals) > 20 and config.sip_cycle:
            rate, expected = len(intervals) / sum(intervals), 1000 / config.sip_cycle
            if rate < _RATE_SHARE * expected:
                yield f"only {rate:.1f} of {expected:.0f} status packets a second arrive (check cable and network)"

    def _of_limits(self, connection: Connection) -> Iterator[str]:
        bounds, limits = connection.bounds, self._limits
        for name, wanted, possible, unit in (
            ("max_linear", limits.max_linear, bounds.forward / 1000, "m/s"),
            ("max_angular_deg", math.degrees(limits.max_angular), bounds.rotation, "degree/s"),
        ):
            if wanted > possible * 1.02:
                yield f"limits.{name} is {wanted:.3g} {unit}, but the robot's top is {possible:.3g} (lower it)"


def percentile(values: Sequence[float], share: float) -> float:
    """Return the value that a share of the values do not exceed; 0 without any."""
    ordered = sorted(values)
    return ordered[min(math.ceil(share * len(ordered)), len(ordered)) - 1] if ordered else 0.0


def _rate(intervals: Sequence[float]) -> str:
    return f"{len(intervals) / sum(intervals):.1f} Hz" if sum(intervals) > 0 else "unknown"


def _jitter(intervals: Sequence[float], period: float | None = None) -> str:
    """Say how far 99 of 100 intervals keep to their period, or to their mean."""
    if len(intervals) < 2:
        return "unknown"
    centre = period or sum(intervals) / len(intervals)
    return f"{percentile([abs(interval - centre) for interval in intervals], 0.99) * 1000:.1f} ms p99"
