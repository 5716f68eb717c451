"""What is counted and timed of a LiDAR."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

_SCANS = 50


class Tally:
    """Counts since the device was opened. One thread counts, any may read."""

    def __init__(self) -> None:
        self.scans = 0
        self.broken = 0
        """Answers left out for a wrong checksum or length."""
        self.reconnects = 0
        self._arrivals: deque[float] = deque(maxlen=_SCANS)
        self._ages: deque[float] = deque(maxlen=_SCANS)

    def count(self, arrival: float, stamp: float) -> None:
        """Note a scan, measured at ``stamp`` and there at ``arrival`` [s]."""
        self.scans += 1
        self._arrivals.append(arrival)
        self._ages.append(arrival - stamp)

    def begin_anew(self) -> None:
        """Forget the times of the scans, not their number: a new connection."""
        self._arrivals.clear()
        self._ages.clear()

    def rate(self, now: float) -> float:
        """Return the rate of the last scans [Hz]; 0 without any in the last second."""
        arrivals = tuple(self._arrivals)
        if len(arrivals) < 2 or now - arrivals[-1] > 1.0:
            return 0.0
        return (len(arrivals) - 1) / max(arrivals[-1] - arrivals[0], 1e-9)

    def figures(self, now: float) -> Mapping[str, str]:
        """Return rate, age and counts for people."""
        ages = sorted(self._ages)
        age = f"{ages[len(ages) // 2] * 1e3:.0f} ms, {ages[-1] * 1e3:.0f} ms at most" if ages else "-"
        return {
            "rate": f"{self.rate(now):.1f} Hz",
            "age on arrival": age,
            "scans": str(self.scans),
            "checksum errors": str(self.broken),
            "reconnects": str(self.reconnects),
        }
